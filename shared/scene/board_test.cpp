#include "scene/board.h"

#include <gtest/gtest.h>

#include <string>

namespace drupe {
namespace {

std::string BoardErrorField(const Json& json) {
  const auto board = ParseBoard(json);
  if (board.ok()) return "ok";
  EXPECT_EQ(board.status().code(), "invalid_board");
  EXPECT_EQ(board.status().kind(), StatusKind::kInvalidArgument);
  return board.status().field();
}

TEST(BoardTest, DefaultBoardRunsRowByRowFromTheTopLeft) {
  const Board board = MakeGridBoard();
  ASSERT_EQ(board.corners_mm.size(), 81U);
  EXPECT_EQ(board.corners_mm.at(0)[0], Eigen::Vector3d(-52, 52, 0));
  EXPECT_EQ(board.corners_mm.at(0)[1], Eigen::Vector3d(-44, 52, 0));
  EXPECT_EQ(board.corners_mm.at(0)[2], Eigen::Vector3d(-44, 44, 0));
  EXPECT_EQ(board.corners_mm.at(0)[3], Eigen::Vector3d(-52, 44, 0));
  EXPECT_EQ(board.corners_mm.at(1)[0], Eigen::Vector3d(-40, 52, 0));
  EXPECT_EQ(board.corners_mm.at(9)[0], Eigen::Vector3d(-52, 40, 0));
  EXPECT_EQ(board.corners_mm.at(40)[0], Eigen::Vector3d(-4, 4, 0));
}

TEST(BoardTest, SurvivesJson) {
  const Board board = MakeGridBoard(3, 2, 10, 15, "DICT_5X5_50");
  const auto json = ParseJson(DumpJson(ToJson(board)));
  ASSERT_TRUE(json.ok());
  const auto read = ParseBoard(*json);
  ASSERT_TRUE(read.ok()) << read.status().ToString();
  EXPECT_EQ(read->dictionary, "DICT_5X5_50");
  EXPECT_EQ(read->corners_mm, board.corners_mm);
}

TEST(BoardTest, NamesWhatIsWrong) {
  const Json good = ToJson(MakeGridBoard(2, 2));
  EXPECT_EQ(BoardErrorField(good), "ok");
  EXPECT_EQ(BoardErrorField(Json::array()), "board");

  Json json = good;
  json["dictionary"] = "DICT_9X9";
  EXPECT_EQ(BoardErrorField(json), "dictionary");
  json["dictionary"] = 3;
  EXPECT_EQ(BoardErrorField(json), "dictionary");

  for (const char* id : {"250", "-1", "01", "x", "", "99999999999"}) {
    json = good;
    json["corners_mm"][id] = good["corners_mm"]["0"];
    EXPECT_EQ(BoardErrorField(json), std::string("corners_mm.") + id);
  }

  json = good;
  json["corners_mm"]["1"].erase(3);
  EXPECT_EQ(BoardErrorField(json), "corners_mm.1");
  json = good;
  json["corners_mm"]["1"][2] = {1, 2};
  EXPECT_EQ(BoardErrorField(json), "corners_mm.1");
  json["corners_mm"]["1"][2] = {1e300, 2, 0};
  EXPECT_EQ(BoardErrorField(json), "corners_mm.1");
  json = good;
  json["corners_mm"]["1"][0][2] = 0.5;
  EXPECT_EQ(BoardErrorField(json), "corners_mm.1");
}

TEST(BoardTest, RefusesMirroredMarkersAndTooMany) {
  Json json = ToJson(MakeGridBoard(2, 2));
  std::swap(json["corners_mm"]["0"][0], json["corners_mm"]["0"][1]);
  std::swap(json["corners_mm"]["0"][2], json["corners_mm"]["0"][3]);
  EXPECT_EQ(BoardErrorField(json), "corners_mm.0");
  EXPECT_EQ(BoardErrorField(ToJson(MakeGridBoard(40, 26, 8, 12, "DICT_ARUCO_ORIGINAL"))), "corners_mm");
  json["corners_mm"] = Json::object();
  EXPECT_EQ(BoardErrorField(json), "corners_mm");
}

}  // namespace
}  // namespace drupe
