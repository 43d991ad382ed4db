#include "services/semantic_map/picture/canvas.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <filesystem>

#include "services/semantic_map/picture/map_picture.hpp"
#include "services/semantic_map/picture/png_file.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::semantic_map::picture {
namespace {

constexpr Colour kDark{24, 62, 40};
constexpr Colour kWhite{255, 255, 255};

/// Pixels of a rectangle that are not dark any more.
int drawn_in(const Canvas& canvas, int x0, int y0, int x1, int y1) {
  int count = 0;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) count += canvas.at(x, y) == kDark ? 0 : 1;
  }
  return count;
}

TEST(Canvas, FillsWholePixelsWithExactlyTheColour) {
  Canvas canvas(8, 4, kDark);
  for (int value = 0; value < 256; ++value) {
    const Colour colour{static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(255 - value), 7};
    canvas.fill(2, 1, 3, 2, colour);
    EXPECT_EQ(canvas.at(2, 1), colour);
    EXPECT_EQ(canvas.at(4, 2), colour);
    EXPECT_EQ(canvas.at(5, 2), kDark);
    EXPECT_EQ(canvas.at(4, 3), kDark);
  }
}

TEST(Canvas, CutsOffWhatIsOutside) {
  Canvas canvas(8, 4, kDark);
  canvas.fill(-5, -5, 6, 6, kWhite);
  canvas.fill(7, 3, 100, 100, kWhite);
  canvas.fill(100, 100, 5, 5, kWhite);
  canvas.fill(-10, 0, 3, 3, kWhite);
  canvas.line(-100, 2, -50, 2, 3, kWhite);
  EXPECT_EQ(drawn_in(canvas, 0, 0, 8, 4), 2);
}

TEST(Canvas, DrawsLinesOfTheirThickness) {
  Canvas canvas(40, 20, kDark);
  canvas.line(10, 10, 30, 10, 4, kWhite);
  EXPECT_EQ(canvas.at(20, 8), kWhite);
  EXPECT_EQ(canvas.at(20, 11), kWhite);
  EXPECT_EQ(canvas.at(20, 7), kDark);
  EXPECT_EQ(canvas.at(20, 12), kDark);
  EXPECT_EQ(canvas.at(5, 10), kDark);
  canvas.disc(5, 5, 3, kWhite);
  EXPECT_EQ(canvas.at(4, 4), kWhite) << "a line without length is a disc";
}

TEST(Canvas, WritesWordsAsHighAsItSays) {
  Canvas canvas(200, 60, kDark);
  const int width = canvas.text_width("H", 3);
  if (width == 0) GTEST_SKIP() << "no font is installed";
  canvas.text(10, 10, "H", 3, kWhite);
  EXPECT_GT(drawn_in(canvas, 10, 10, 10 + width, 10 + 3 * Canvas::kTextHeight), 60);
  EXPECT_EQ(drawn_in(canvas, 0, 0, 200, 8), 0);
  EXPECT_EQ(drawn_in(canvas, 0, 12 + 3 * Canvas::kTextHeight, 200, 60), 0);
  EXPECT_GT(canvas.text_width("HHHH", 3), 3 * width);
}

TEST(MapPicture, CellsHaveTheColoursOfTheirClasses) {
  MapPicture map;
  tile::MapTile& tile = map.tiles.emplace_back();
  tile.height.fill(tile::MapTile::kNoHeight);
  for (int i = 0; i < tile::kCellsInTile; ++i)
    tile.cell_class[static_cast<std::size_t>(i)] = static_cast<tile::CellClass>(i % tile::kNumClasses);
  // What is unknown at the border is cut off.
  for (const int corner : {0, kCellsPerTile - 1, tile::kCellsInTile - kCellsPerTile, tile::kCellsInTile - 1})
    tile.cell_class[static_cast<std::size_t>(corner)] = tile::CellClass::kRoad;
  constexpr int kScale = 4;
  const Canvas canvas =
      draw_map(map, {.title = "", .pixels_per_cell = kScale, .shade = false, .legend = false, .margin = 0});
  ASSERT_EQ(canvas.width(), kCellsPerTile * kScale);
  ASSERT_EQ(canvas.height(), kCellsPerTile * kScale);
  for (int y = 0; y < canvas.height(); ++y) {
    for (int x = 0; x < canvas.width(); ++x) {
      const int cell = (kCellsPerTile - 1 - y / kScale) * kCellsPerTile + x / kScale;
      ASSERT_EQ(canvas.at(x, y), class_colour(tile.cell_class[static_cast<std::size_t>(cell)])) << x << ' ' << y;
    }
  }
}

TEST(PngFile, SaysWhyItCannotBeWritten) {
  const Canvas canvas(4, 4, kDark);
  const auto folder = std::filesystem::temp_directory_path() / ("canvas_" + std::to_string(getpid()));
  const std::string path = (folder / "map.png").string();
  try {
    write_png(canvas, path);
    FAIL() << "there is no such folder";
  } catch (const PictureError& error) {
    EXPECT_EQ(error.what(), path + ": cannot write the picture: No such file or directory");
  }
  std::filesystem::create_directories(folder);
  write_png(canvas, path);
  EXPECT_GT(std::filesystem::file_size(path), 60U);
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
  std::filesystem::remove_all(folder);
}

/// As root `--picture /dev/null` put a picture in the device's place, for the whole machine.
TEST(PngFile, LeavesWhatIsNoRegularFileInItsPlace) {
  const test::TemporaryFolder folder;
  const std::string pipe = folder / "pipe";
  const std::string link = folder / "link";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::filesystem::create_symlink(pipe, link);
  const int reader = open(pipe.c_str(), O_RDWR | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  for (const std::string& path : {pipe, link}) {
    write_png(Canvas(4, 4, kDark), path);
    std::array<char, 4096> bytes{};
    EXPECT_GT(read(reader, bytes.data(), bytes.size()), 60);
    EXPECT_EQ(std::string(bytes.data() + 1, 3), "PNG");
  }
  close(reader);
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_TRUE(std::filesystem::is_symlink(link));
}

}  // namespace
}  // namespace curbstone::semantic_map::picture
