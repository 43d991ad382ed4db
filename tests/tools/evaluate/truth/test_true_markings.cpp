#include "tools/evaluate/truth/true_markings.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>

#include "tests/temporary_folder.hpp"

namespace curbstone::evaluate::truth {
namespace {

/// The complaint about a file of one row.
std::string complaint_about(const std::string& row) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "markings.csv") << "line,piece,type,width,x,y,z\n" << row << "\n";
  try {
    (void)read_markings(folder.path());
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(TrueMarkings, AreLinesOfPieces) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "markings.csv") << "line,piece,type,width,x,y,z\n"
                                            "0,0,dashed,0.120,0,0,1\n0,0,dashed,0.120,3,0,1\n"
                                            "0,1,dashed,0.120,9,0,1\n0,1,dashed,0.120,12,0,1\n"
                                            "1,0,stop_line,0.400,5,1,1\n1,0,stop_line,0.400,5,4,2\n";
  const auto markings = read_markings(folder.path());
  ASSERT_EQ(markings.size(), 2U);
  EXPECT_EQ(markings[0].type, TrueMarking::Type::kDashed);
  ASSERT_EQ(markings[0].pieces.size(), 2U);
  EXPECT_EQ(markings[0].pieces[1].centre[1], Eigen::Vector3d(12, 0, 1));
  EXPECT_EQ(markings[1].type, TrueMarking::Type::kStopLine);
  EXPECT_EQ(markings[1].pieces[0].width, 0.4);
}

TEST(TrueMarkings, AreNoneWhereNobodySaysWhatIsPainted) {
  EXPECT_TRUE(read_markings(test::TemporaryFolder().path()).empty());
}

TEST(TrueMarkings, SayWhichRowIsWrong) {
  for (const char* row :
       {"0,0,wavy,0.12,0,0,0", "0,0,solid,0,0,0,0", "0,0,solid,0.12,0,0", "0,0,solid,0.12,nan,0,0", "0"})
    EXPECT_NE(complaint_about(row).find("markings.csv:2: expected"), std::string::npos) << row;
  EXPECT_NE(complaint_about("0,0,solid,0.12,0,0,0").find("two vertices"), std::string::npos);
}

}  // namespace
}  // namespace curbstone::evaluate::truth
