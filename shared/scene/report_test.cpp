#include "scene/report.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace drupe {
namespace {

Report OneSpot() {
  Defect spot;
  spot.id = 1;
  spot.defect_class = DefectClass::kRainSpot;
  spot.area_mm2 = 5.41151;
  spot.roundness = 0.92;
  spot.area_share_pct = 0.128;
  spot.contour_mm = {{1, 2, 3}, {4, 5, 6}, {7, 8, 10}};
  Fruit spotted;
  spotted.id = 1;
  spotted.grade = DefectClass::kRainSpot;
  spotted.volume_mm3 = 25772.7;
  spotted.defects = {spot};
  Fruit intact;
  intact.id = 2;
  Report report;
  report.id = "rec_1";
  report.scale_source = ScaleSource::kBoard;
  report.fruits = {spotted, intact};
  return report;
}

TEST(ReportJson, MetricLengthsAreWritten) {
  const Json json = ToJson(OneSpot());
  EXPECT_EQ(json["unit"], "mm");
  EXPECT_EQ(json["fruits"][0]["grade"], "rain_spot");
  EXPECT_EQ(json["fruits"][0]["defects"][0]["area_mm2"], 5.4115);  // rounded to 0.1 micrometres
  EXPECT_EQ(json["fruits"][0]["defects"][0]["contour_mm"][2][2], 10);
  EXPECT_EQ(json["fruits"][1]["grade"], "intact");
}

TEST(ReportJson, WithoutScaleOnlySharesRemain) {
  Report report = OneSpot();
  report.scale_source = ScaleSource::kNone;
  const Json json = ToJson(report);
  const Json& defect = json["fruits"][0]["defects"][0];
  EXPECT_TRUE(json["unit"].is_null());
  EXPECT_TRUE(json["fruits"][0]["volume_mm3"].is_null());
  EXPECT_TRUE(defect["area_mm2"].is_null());
  EXPECT_TRUE(defect["contour_mm"].is_null());
  EXPECT_EQ(defect["area_share_pct"], 0.128);
  EXPECT_EQ(defect["roundness"], 0.92);
}

TEST(ReportJson, NumbersThatAreNoneBecomeNull) {
  Report report = OneSpot();
  report.fruits[0].sphericity = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(ToJson(report)["fruits"][0]["sphericity"].is_null());
}

TEST(ReportCsv, EveryLineHasTheHeadersColumns) {
  const std::string csv = ToCsv(OneSpot());
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < csv.size();) {
    const std::size_t end = csv.find("\r\n", begin);
    ASSERT_NE(end, std::string::npos);
    lines.push_back(csv.substr(begin, end - begin));
    begin = end + 2;
  }
  ASSERT_EQ(lines.size(), 3u);  // header, the spot, the intact fruit
  for (const std::string& line : lines) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), std::count(lines[0].begin(), lines[0].end(), ',')) << line;
  }
  EXPECT_NE(lines[1].find("rain_spot,0.0,5.4115"), std::string::npos) << lines[1];
}

TEST(ReportCsv, NoFruitGivesTheHeaderAlone) {
  const std::string csv = ToCsv(Report());
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1);
}

}  // namespace
}  // namespace drupe
