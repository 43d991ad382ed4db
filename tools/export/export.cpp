#include "tools/export/export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "common/config/command_line.hpp"
#include "common/config/config.hpp"
#include "config/sections.hpp"
#include "services/semantic_map/semantic_map_config.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "tools/export/cloud_writer.hpp"
#include "tools/export/geojson_file.hpp"
#include "tools/export/georeference.hpp"
#include "tools/export/lanelet2_file.hpp"
#include "tools/export/marking_export.hpp"
#include "tools/export/mcap/mcap_file.hpp"
#include "tools/export/nav2_map.hpp"
#include "tools/export/raster_file.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/recording/recorded_config.hpp"

namespace curbstone::map_export {

namespace {

struct ExportArguments {
  std::string map;
  std::string out = "export";
  std::vector<std::string> only;
  Nav2Policy nav2;
  double high_curb = kHighCurb;
  std::string datum;
  std::string log;
  std::string config;
  CloudFormat cloud_format = CloudFormat::kPcd;
  mcap::McapSettings mcap;
  bool without_raw = false;

  [[nodiscard]] bool wants(const char* what) const { return only.empty() || names(what); }
  [[nodiscard]] bool names(const char* what) const { return std::find(only.begin(), only.end(), what) != only.end(); }
  /// MCAP is made from a log only, without a map.
  [[nodiscard]] bool only_mcap() const { return names("mcap") && only.size() == 1; }
};

void add_nav2(const MapGrid& grid, const Nav2Policy& policy, output::OutputFolder& out) {
  out.add_bytes("nav2.pgm", pgm_bytes(grid.columns, grid.rows, trinary_pixels(grid, policy)));
  out.add_bytes("nav2.yaml", nav2_yaml(grid, "nav2.pgm", "trinary"));
  out.add("nav2_scale.png", [&](const std::string& path) {
    write_gray_alpha_png(grid.columns, grid.rows, scale_pixels(grid, policy), path);
  });
  out.add_bytes("nav2_scale.yaml", nav2_yaml(grid, "nav2_scale.png", "scale"));
}

void add_rasters(const MapGrid& grid, bool with_hits, const std::optional<geo::TangentPlane>& plane,
                 output::OutputFolder& out) {
  const Georeference place(grid, plane);
  const auto add_place = [&](const std::string& image, const std::string& world_file) {
    out.add_bytes(world_file, place.world_file());
    if (const auto projection = place.projection_file()) {
      out.add_bytes(image + ".aux.xml", *projection);
    } else {
      out.leave_out(image + ".aux.xml");
    }
  };
  const auto add_gray = [&](const std::string& name, const std::vector<std::uint8_t>& values) {
    out.add(name + ".png", [&](const std::string& path) { write_gray_png(grid.columns, grid.rows, values, path); });
    add_place(name + ".png", name + ".pgw");
  };
  const auto add_float = [&](const std::string& name, const std::vector<float>& values) {
    out.add_bytes(name + ".flt", float_bytes(values));
    out.add_bytes(name + ".hdr", float_header(grid.columns, grid.rows));
    add_place(name + ".flt", name + ".wld");
  };
  out.add("class.png", [&](const std::string& path) { write_class_png(grid, path); });
  add_place("class.png", "class.pgw");
  add_gray("cost", grid.cost);
  add_gray("confidence", grid.confidence);
  if (with_hits) {
    add_gray("hits", grid.hits);
  } else {
    for (const char* name : {"hits.png", "hits.pgw", "hits.png.aux.xml"}) out.leave_out(name);
    fmt::print("no hits: the map is of schema 1, which does not count them\n");
  }
  add_float("height", grid.height);
  add_float("slope", ground_slope(grid));
}

void add_curbs(const semantic_map::store::MapReader& map, double high_curb,
               const std::optional<geo::TangentPlane>& plane, output::OutputFolder& out) {
  std::vector<semantic_map::tile::CurbLine> all = map.curbs();
  const std::size_t count = all.size();
  const std::vector<semantic_map::tile::CurbLine> curbs = usable_curbs(std::move(all));
  if (curbs.size() != count)
    fmt::print("{} curb lines left out: single points, or out of reach\n", count - curbs.size());
  if (curbs.empty()) fmt::print("the map holds no curb lines\n");
  CurbView view{high_curb};
  for (const semantic_map::tile::TrajectoryPose& pose : map.trajectory())
    view.path.add(pose.utime, pose.T_map_base.translation().head<2>());
  out.add_bytes("curbs.osm", lanelet2_osm(curbs, view, plane));
  if (plane) {
    out.add_bytes("curbs.geojson", curbs_geojson(curbs, view, *plane));
  } else {
    out.leave_out("curbs.geojson");
  }
}

void add_markings(const semantic_map::store::MapReader& map, const std::optional<geo::TangentPlane>& plane,
                  output::OutputFolder& out) {
  const std::vector<semantic_map::tile::MarkingLine> lines = usable_markings(map.markings());
  if (lines.empty()) fmt::print("the map holds no road markings\n");
  out.add_bytes("markings.osm", markings_osm(lines, plane));
  if (plane) {
    out.add_bytes("markings.geojson", markings_geojson(lines, *plane));
  } else {
    out.leave_out("markings.geojson");
  }
}

/// Returns whether the log is damaged.
bool add_cloud(const ExportArguments& arguments, std::int32_t epoch, output::OutputFolder& out) {
  const DenseCloud cloud = read_dense_cloud(arguments.log, epoch);
  if (cloud.missing + cloud.refused > 0)
    fmt::print("{}: {} points are missing in it, {} messages refused\n", arguments.log, cloud.missing, cloud.refused);
  out.add(arguments.cloud_format == CloudFormat::kPcd ? "cloud.pcd" : "cloud.ply",
          [&](const std::string& path) { write_cloud(cloud, arguments.cloud_format, path); });
  fmt::print("{} points in the dense cloud\n", cloud.points.size());
  return cloud.log_is_damaged;
}

/// Returns whether the log is damaged.
bool add_mcap(const ExportArguments& arguments, output::OutputFolder& out) {
  const std::string& log = arguments.log.empty() ? arguments.map : arguments.log;
  auto config = config_of<viewer::ViewerConfig>("viewer", kProcessSections, arguments.config, {});
  if (arguments.config.empty()) {
    LogFiles head({log});
    config.vehicle = recording::recorded_config(head).vehicle();
  }
  bool is_damaged = false;
  out.add("drive.mcap", [&](const std::string& path) {
    const mcap::McapResult result = mcap::write_mcap(log, path, config, arguments.mcap);
    fmt::print("{} messages in drive.mcap\n", result.messages);
    if (result.refused > 0) fmt::print("{}: {} messages refused\n", log, result.refused);
    if (result.left_out > 0)
      fmt::print("{}: {} messages left out: more than {} channels\n", log, result.left_out, mcap::kMaxRawChannels);
    if (!result.has_map)
      fmt::print("{} holds no map: 'curbstone replay {} --record all.lcmlog' adds it to what it reads\n", log, log);
    is_damaged = result.log_is_damaged;
  });
  return is_damaged;
}

/// Returns whether the log is damaged.
bool export_log(const ExportArguments& arguments) {
  output::OutputFolder out(arguments.out);
  const bool is_damaged = add_mcap(arguments, out);
  for (const std::string& name : out.commit()) fmt::print("{}/{}\n", arguments.out, name);
  return is_damaged;
}

/// Returns whether the log (if any) is damaged.
bool export_map(const ExportArguments& arguments, const std::optional<geo::TangentPlane>& plane) {
  const semantic_map::store::MapReader map(arguments.map);
  const semantic_map::store::MapReader::Moment now(map);  // the drive may go on
  output::OutputFolder out(arguments.out);
  if (arguments.wants("nav2") || arguments.wants("rasters")) {
    std::optional<MapGrid> grid;
    try {
      grid = make_map_grid(map.tiles());
    } catch (const MapGridError& error) {
      throw MapGridError(fmt::format("{}: {}", arguments.map, error.what()));
    }
    if (arguments.wants("nav2")) add_nav2(*grid, arguments.nav2, out);
    if (arguments.wants("rasters")) add_rasters(*grid, map.schema() >= 2, plane, out);
  }
  if (arguments.wants("curbs")) add_curbs(map, arguments.high_curb, plane, out);
  if (arguments.wants("markings")) add_markings(map, plane, out);
  bool is_damaged = !arguments.log.empty() && arguments.wants("cloud") && add_cloud(arguments, map.epoch(), out);
  if (arguments.names("mcap")) is_damaged = add_mcap(arguments, out) || is_damaged;
  if (!plane && (arguments.wants("curbs") || arguments.wants("markings")))
    fmt::print(
        "no lat, lon in the .osm files, which Lanelet2's own projectors and JOSM need: give --datum. Autoware's local "
        "projector reads them as they are\n");
  if (arguments.log.empty() && arguments.only.empty())
    fmt::print("no cloud: a map file keeps no points; give the log of its MAP_POINTS with --log\n");
  for (const std::string& name : out.commit()) fmt::print("{}/{}\n", arguments.out, name);
  return is_damaged;
}

void add_options(CommandLine& line, ExportArguments& arguments) {
  line.argument("map", arguments.map, "The map file; with --only mcap, a log or the folder of a session").required();
  line.option("--out", arguments.out, "Folder for the results").shows_default();
  line.option("--only", arguments.only, "What to write; default: everything but mcap")
      .comma_separated()
      .one_of({"nav2", "rasters", "curbs", "markings", "cloud", "mcap"});
  line.option("--config", arguments.config,
              "The vehicle's YAML file: its semantic_map.classes.unknown_is_free decides where --unknown is not given; "
              "mcap: its vehicle, instead of the one that the log recorded");
  line.choice(
      "--unknown", arguments.nav2.unknown,
      {{"occupied", UnknownCells::kOccupied}, {"unknown", UnknownCells::kUnknown}, {"free", UnknownCells::kFree}},
      "nav2: what never was seen is occupied (safe, the default), unknown (the planner decides) or free");
  line.option("--occupied-cost", arguments.nav2.occupied_cost,
              "nav2, trinary: cells of this cost and more are occupied; 50: every curb, 254: what cannot be crossed")
      .within(1, 254)
      .shows_default();
  line.option("--high-curb", arguments.high_curb, "m: curbs lower than this get subtype low")
      .within(0.0, 1.0)
      .shows_default();
  line.option("--datum", arguments.datum,
              "LAT,LON[,ALT[,HEADING]] of the map's origin: deg WGS84, m above the ellipsoid, deg from north "
              "(clockwise) of its x axis (90: x is east)");
  line.option("--log", arguments.log, "Log with MAP_POINTS: adds the dense cloud");
  line.choice("--cloud-format", arguments.cloud_format, {{"pcd", CloudFormat::kPcd}, {"ply", CloudFormat::kPly}},
              "pcd (the default) or ply");
  line.choice("--compression", arguments.mcap.compression,
              {{"zstd", McapCompression::kZstd}, {"none", McapCompression::kNone}}, "mcap: zstd (the default) or none");
  line.flag("--without-raw", arguments.without_raw,
            "mcap: leaves out the log's own messages, which only our tools read");
}

/// The contradiction between the arguments; empty if they are consistent.
std::optional<std::string> contradiction_in(const ExportArguments& arguments) {
  if (!arguments.log.empty()) return std::nullopt;
  if (!arguments.only.empty() && arguments.wants("cloud"))
    return "--only: cloud needs --log: a map file keeps no points";
  if (arguments.names("mcap") && !arguments.only_mcap())
    return "--only: mcap is made of a log: give it with --log, or ask for mcap alone";
  return std::nullopt;
}

bool is_unknown_free(const std::string& config) {
  return config_of<semantic_map::SemanticMapConfig>("semantic_map", kProcessSections, config, {})
      .classes.unknown_is_free;
}

}  // namespace

int run_export(int argc, char** argv) {
  ExportArguments arguments;
  CommandLine line(
      "Writes a map file in the formats of others: nav2, QGIS and GDAL, Lanelet2, GeoJSON, PCD, PLY; or a log as MCAP",
      "curbstone export");
  add_options(line, arguments);
  if (const auto status = line.read(argc, argv)) return *status;
  std::optional<geo::TangentPlane> plane;
  if (!arguments.datum.empty()) {
    const auto datum = geo::parse_datum(arguments.datum);
    if (!datum) return line.refuse("--datum: " + arguments.datum + " is not LAT,LON[,ALT[,HEADING]] on the Earth");
    plane.emplace(*datum);
  }
  if (const auto contradiction = contradiction_in(arguments)) return line.refuse(*contradiction);
  arguments.mcap.raw = !arguments.without_raw;
  if (arguments.only_mcap()) return export_log(arguments) ? 1 : 0;
  const bool unknown_is_free = is_unknown_free(arguments.config);
  if (!line.given("--unknown") && unknown_is_free) arguments.nav2.unknown = UnknownCells::kFree;
  return export_map(arguments, plane) ? 1 : 0;
}

}  // namespace curbstone::map_export
