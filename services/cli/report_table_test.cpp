#include "cli/report_table.h"

#include <gtest/gtest.h>

namespace drupe {
namespace {

Report OneSpot() {
  Report report;
  report.scale_source = ScaleSource::kBoard;
  Fruit fruit;
  fruit.id = 1;
  fruit.grade = DefectClass::kRainSpot;
  fruit.surface_area_mm2 = 4000;
  Defect defect;
  defect.id = 1;
  defect.area_mm2 = 4.25;
  defect.roundness = 0.912;
  fruit.defects.push_back(defect);
  report.fruits.push_back(fruit);
  return report;
}

TEST(ReportTable, MetricReportShowsMillimetres) {
  const std::string table = ReportTable(OneSpot());
  EXPECT_NE(table.find("rain_spot"), std::string::npos) << table;
  EXPECT_NE(table.find("4.250"), std::string::npos) << table;
  EXPECT_NE(table.find("0.912"), std::string::npos) << table;
}

TEST(ReportTable, WithoutScaleOnlySharesRemain) {
  Report report = OneSpot();
  report.scale_source = ScaleSource::kNone;
  const std::string table = ReportTable(report);
  EXPECT_EQ(table.find("mm"), std::string::npos) << table;
  EXPECT_NE(table.find("0.106 % of the surface"), std::string::npos) << table;
}

TEST(ReportTable, NoFruitIsSaid) {
  EXPECT_EQ(ReportTable(Report()), "No fruit found.\n");
}

}  // namespace
}  // namespace drupe
