#include "tools/detect/cloud_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <pcl/io/lzf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <random>

#include "tests/temporary_folder.hpp"

namespace curbstone::detect {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

constexpr float kPoints[4][3] = {{1, 2, 3}, {-4.5F, 5.25F, -0.5F}, {0.125F, 7, 1000}, {0.5F, -0.25F, 8}};

/// The points, one a line, each in a format of fmt's.
std::string rows(const char* format = "{0} {1} {2}\n") {
  std::string text;
  for (const auto& p : kPoints) text += fmt::format(fmt::runtime(format), p[0], p[1], p[2]);
  return text;
}

std::string with_crlf(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return out;
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kColours = "property uchar blue\nproperty uchar green\nproperty uchar red\n";

std::string ply(const std::string& properties, const std::string& data, const std::string& format = "ascii") {
  return "ply\nformat " + format + " 1.0\ncomment by hand\nobj_info 20 °C\n\nelement vertex 4\n" + properties +
         "end_header\n" + data;
}

std::string pcd(const std::string& fields, const std::string& sizes, const std::string& types,
                const std::string& counts, const std::string& data) {
  return "# .PCD v.7\n\nFIELDS " + fields + "\nSIZE " + sizes + "\nTYPE " + types + "\n" +
         (counts.empty() ? "" : "COUNT " + counts + "\n") + "WIDTH 2\nHEIGHT 2\nPOINTS 4\nDATA ascii\n" + data;
}

template <class Number>
void put(std::string& bytes, Number number, bool big) {
  std::array<char, sizeof(Number)> raw{};
  std::memcpy(raw.data(), &number, sizeof number);
  if (big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.begin(), raw.end());
}

class CloudFileTest : public ::testing::Test {
 protected:
  void expect_read(const char* name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    std::vector<Eigen::Vector3f> points;
    try {
      points = read_cloud(folder_ / name);
    } catch (const CloudFileError& error) {
      ADD_FAILURE() << error.what() << "\n" << bytes;
    }
    ASSERT_EQ(points.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_EQ(points[i], Eigen::Vector3f(kPoints[i][0], kPoints[i][1], kPoints[i][2])) << i << " of\n" << bytes;
  }
  [[nodiscard]] std::string why(const char* name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    try {
      (void)read_cloud(folder_ / name);
    } catch (const CloudFileError& error) {
      return error.what();
    }
    return "";
  }
  test::TemporaryFolder folder_;
};

TEST_F(CloudFileTest, PlyTextOfEveryLayoutIsRead) {
  expect_read("a.ply", ply(kXyz, rows()));
  expect_read("a.ply", "\xEF\xBB\xBF" + with_crlf(ply(kXyz, rows("  {0}\t{1} {2} \n\n"))));
  expect_read("a.ply", ply(kXyz, rows().substr(0, rows().size() - 1)));
  expect_read("a.ply", ply("property float64 x\nproperty float32 y\nproperty double z\n", rows("{0:e} {1:+} {2:E}\n")));
  // PCL's reader took the first point's x for a colour here, and all coordinates in the third.
  expect_read("a.ply", ply(kXyz + kColours + "property float q\n", rows("{0} {1} {2} 1 2 255 nan\n")));
  expect_read("a.ply", ply("property float z\nproperty uchar red\nproperty float y\nproperty float x\n",
                           rows("{2} 9 {1} {0}\n")));
  expect_read("a.ply", ply("property uchar red\n" + kXyz, rows("255 {0} {1} {2}\n")));
  expect_read("a.ply", ply("property list uchar int seen_by\n" + kXyz, rows("3 7 8 9 {0} {1} {2}\n")));
  expect_read("a.ply", ply(kXyz + "element face 1\nproperty list uchar int vertex_indices\n", rows() + "3 0 1 2\n"));
  std::string camera = ply(kXyz, "0.5 1\n" + rows());
  camera.insert(camera.find("element vertex"), "element camera 1\nproperty float focal\nproperty int id\n");
  expect_read("a.ply", camera);
}

TEST_F(CloudFileTest, BinaryPlyOfBothByteOrdersIsRead) {
  for (const bool big : {false, true}) {
    std::string floats, doubles, lists;
    put(lists, std::uint16_t{2}, big);  // of the element before the vertices
    put(lists, std::int32_t{7}, big);
    put(lists, std::int32_t{8}, big);
    for (const auto& p : kPoints) {
      put(lists, std::int8_t{-1}, big);
      for (const float value : p) {
        put(floats, value, big);
        put(doubles, static_cast<double>(value), big);
        put(lists, value, big);
      }
      doubles += "\n";  // a colour that looks like the end of a line
    }
    const std::string format = big ? "binary_big_endian" : "binary_little_endian";
    expect_read("a.ply", ply(kXyz, floats, format));
    expect_read("a.ply",
                ply("property double x\nproperty double y\nproperty double z\nproperty uchar red\n", doubles, format));
    std::string faces = ply("property char label\n" + kXyz, lists, format);
    faces.insert(faces.find("element vertex"), "element face 1\nproperty list ushort int vertex_indices\n");
    expect_read("a.ply", faces);
    EXPECT_THAT(why("a.ply", ply(kXyz, floats.substr(0, 47), format)), EndsWith("a.ply: truncated"));
  }
}

TEST_F(CloudFileTest, PcdTextOfEveryLayoutIsRead) {
  expect_read("a.pcd", pcd("x y z", "4 4 4", "F F F", "", rows()));
  expect_read("a.pcd", "\xEF\xBB\xBF" + with_crlf(pcd("x y z", "8 8 8", "F F F", "1 1 1", rows(" {0}\t{1} {2}\n\n"))));
  expect_read("a.pcd", pcd("fpfh z y x _", "4 4 4 8 1", "F F F F U", "3 1 1 1 2", rows("1 2 3 {2} {1} {0} 0 0\n")));
  expect_read("a.pcd", pcd("x y z rgb", "4 4 4 4", "F F F U", "1 1 1 1", rows("{0} {1} {2} 4294967295\n")));
}

/// Of every point: a byte of padding, z as a double, then y and x.
TEST_F(CloudFileTest, BinaryPcdIsReadCompressedOrNot) {
  const auto head = [](const char* data) {
    std::string text = pcd("_ z y x", "1 8 4 4", "U F F F", "3 1 1 1", "");
    return text.replace(text.find("ascii"), 5, data);
  };
  std::string records, x, y, z;
  for (const auto& p : kPoints) {
    records += "abc";
    put(records, static_cast<double>(p[2]), false), put(z, static_cast<double>(p[2]), false);
    put(records, p[1], false), put(y, p[1], false);
    put(records, p[0], false), put(x, p[0], false);
  }
  expect_read("a.pcd", head("binary") + records);
  expect_read("a.pcd", "\xEF\xBB\xBF" + with_crlf(head("binary")) + records);
  const std::string columns = std::string(12, 'a') + z + y + x;
  std::string small(columns.size(), '\0');
  small.resize(pcl::lzfCompress(columns.data(), static_cast<unsigned>(columns.size()), small.data(),
                                static_cast<unsigned>(small.size())));
  ASSERT_GT(small.size(), 0U);
  std::string compressed = head("binary_compressed");
  put(compressed, static_cast<std::uint32_t>(small.size()), false);
  put(compressed, static_cast<std::uint32_t>(columns.size()), false);
  expect_read("a.pcd", compressed + small);

  EXPECT_THAT(why("a.pcd", head("binary") + records.substr(1)), HasSubstr("truncated"));
  EXPECT_THAT(why("a.pcd", (compressed + small).substr(0, compressed.size() + 9)), HasSubstr("truncated"));
  EXPECT_THAT(why("a.pcd", compressed + std::string(small.size(), '\x20')), HasSubstr("damaged"));
  EXPECT_THAT(why("a.pcd", head("bin")), HasSubstr("its points are \"bin\""));
}

/// Where PCL reads zeros.
TEST_F(CloudFileTest, TextThatIsNoNumberIsAnErrorWithItsLine) {
  std::string commas = rows();
  std::ranges::replace(commas, '.', ',');
  EXPECT_THAT(why("a.pcd", pcd("x y z", "4 4 4", "F F F", "", commas)), HasSubstr("a.pcd:11: \"-4,5\" is no number"));
  EXPECT_THAT(why("a.ply", ply(kXyz, commas)), HasSubstr("a.ply:12: \"-4,5\" is no number"));
  EXPECT_THAT(why("a.pcd", pcd("x y z", "4 4 4", "F F F", "", rows("{0},{1},{2}\n"))),
              HasSubstr("\"1,2,3\" is no number"));
  EXPECT_THAT(why("a.pcd", pcd("x y z", "4 4 4", "F F F", "", "1 2 3\n1 2\n1 2 3\n1 2 3\n")),
              HasSubstr("a.pcd:11: too few"));
  EXPECT_THAT(why("a.ply", ply(kXyz, "1 2 3\n1 2 3 4\n1 2 3\n1 2 3\n")), HasSubstr("a.ply:12: more numbers"));
  EXPECT_THAT(why("a.pcd", pcd("x y z", "4 4 4", "F F F", "", rows() + "1 2 3\n")),
              HasSubstr("more than the 4 points"));
  EXPECT_THAT(why("a.pcd", pcd("x y z", "4 4 4", "F F F", "", "1 2 3\n")), EndsWith("a.pcd: truncated: 1 of 4 points"));
  EXPECT_THAT(why("a.ply", ply(kXyz, "1 2 3\n")), EndsWith("a.ply: truncated: 1 of 4 vertices"));
  EXPECT_THAT(why("a.pcd", pcd("x y z", "4 4 4", "I I I", "", rows("1 2 3\n"))), HasSubstr("x y z of float or double"));
  EXPECT_THAT(why("a.ply", ply("property float X\nproperty float Y\nproperty float Z\n", rows())),
              HasSubstr("no x y z"));
  EXPECT_THAT(why("a.ply", ply("property colour x\n" + kXyz, rows())),
              HasSubstr("a.ply:7: a property of an unknown type"));
}

/// PCL crashed on a line that it does not know.
TEST_F(CloudFileTest, AHeaderWithAForeignLineIsRefused) {
  const std::string text = pcd("x y z", "4 4 4", "F F F", "", rows());
  EXPECT_THAT(why("a.pcd", "CREATOR me\n" + text), HasSubstr("line 1 is none of its header"));
  EXPECT_THAT(why("a.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n1 2 3\n"),
              HasSubstr("contradicts itself"));
  EXPECT_THAT(why("a.ply", "ply\nformat ascii 1.0\nelement vertex 99999999999999999999\n" + kXyz + "end_header\n"),
              HasSubstr("more of \"vertex\" than the file can hold"));
}

TEST_F(CloudFileTest, DamageToAPlyDoesNoHarm) {
  std::mt19937 random(5);
  std::string binary;
  for (const auto& p : kPoints) {
    for (const float value : p) put(binary, value, true);
  }
  const std::string files[] = {ply(kXyz + "property list uchar int seen_by\n", rows("{0} {1} {2} 1 5\n")),
                               ply(kXyz, binary, "binary_big_endian"), pcd("x y z", "4 4 4", "F F F", "1 1 1", rows())};
  for (int i = 0; i < 600; ++i) {
    std::string bytes = files[i % 3];
    for (unsigned k = random() % 4; k > 0; --k) bytes[random() % bytes.size()] = static_cast<char>(random());
    bytes.resize(bytes.size() - random() % 3 * (random() % bytes.size()) / 2);
    (void)why(i % 3 == 2 ? "a.pcd" : "a.ply", bytes);
  }
}

}  // namespace
}  // namespace curbstone::detect
