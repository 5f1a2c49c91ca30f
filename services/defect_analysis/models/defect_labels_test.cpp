#include "defect_analysis/models/defect_labels.h"

#include <gtest/gtest.h>

#include "defect_analysis/models/labelled_defects.h"

namespace drupe {
namespace {

Report TwoFruits() {
  Report report;
  report.id = "rec_1";
  report.scale_source = ScaleSource::kBoard;
  report.fruits.resize(2);
  for (int fruit = 0; fruit < 2; ++fruit) {
    report.fruits[fruit].id = fruit + 1;
    for (int k = 1; k <= 3; ++k) {
      Defect defect;
      defect.id = k;
      defect.area_mm2 = 10 * (fruit + 1) + k;
      defect.length_mm = defect.width_mm = 2;
      report.fruits[fruit].defects.push_back(defect);
    }
  }
  return report;
}

TEST(ParseDefectLabels, ReadsWhatSpreadsheetsWrite) {
  const auto labels = ParseDefectLabels(
      "\xEF\xBB\xBF"
      "fruit;area;defect;class;report\r\n1;\"2;5\";3;crack;rec_1\r\n\r\n2;1; 1 ;none;\r\n3;1;;;\r\n");
  ASSERT_TRUE(labels.ok()) << labels.status().message();
  ASSERT_EQ(labels->size(), 2u);
  const DefectLabel& first = labels->front();
  EXPECT_EQ(first.report, "rec_1");
  EXPECT_EQ(first.fruit, 1);
  EXPECT_EQ(first.defect, 3);
  EXPECT_EQ(first.defect_class, DefectClass::kCrack);
  EXPECT_EQ(first.line, 2);
  EXPECT_EQ(labels->back().defect_class, std::nullopt);
  EXPECT_EQ(labels->back().report, "");
}

TEST(ParseDefectLabels, RefusesByLine) {
  const auto field = [](const char* csv) { return ParseDefectLabels(csv).status().field(); };
  EXPECT_EQ(field(""), "line 1");
  EXPECT_EQ(field("defect,kind\n1,crack\n"), "line 1");
  EXPECT_EQ(field("defect,class\n1,crack\n2,bruise\n"), "line 3");
  EXPECT_EQ(field("defect,class\n1,intact\n"), "line 2");
  EXPECT_EQ(field("defect,class\n1x,crack\n"), "line 2");
  EXPECT_EQ(field("defect,class\n0,crack\n"), "line 2");
  EXPECT_EQ(field("fruit,defect,class\n-1,2,crack\n"), "line 2");
  EXPECT_EQ(field("defect,class\n99999999999,crack\n"), "line 2");
  EXPECT_EQ(ParseDefectLabels(std::string(17 << 20, 'x')).status().code(), "bad_labels");
}

TEST(LabelReport, KeepsTheNamedDefectsWithTheirClasses) {
  Json json = ToJson(TwoFruits());
  const auto labels =
      ParseDefectLabels("report,fruit,defect,class\nrec_1,2,3,scar\nrec_2,1,9,scar\nrec_1,2,1,none\nrec_1,1,2,decay\n");
  ASSERT_TRUE(labels.ok());
  ASSERT_TRUE(LabelReport(*labels, json).ok());
  const auto defects = ReadLabelledReport(json);
  ASSERT_TRUE(defects.ok()) << defects.status().message();
  ASSERT_EQ(defects->size(), 2u);
  EXPECT_EQ(defects->front().defect_class, DefectClass::kDecay);
  EXPECT_EQ(defects->back().defect_class, DefectClass::kScar);
  EXPECT_EQ(json["fruits"][1]["defects"][0]["area_mm2"], 23);
}

TEST(LabelReport, RefusesDefectsThatAreNotThere) {
  const auto code = [](const char* csv) {
    Json json = ToJson(TwoFruits());
    return LabelReport(*ParseDefectLabels(csv), json).code();
  };
  EXPECT_EQ(code("fruit,defect,class\n1,4,crack\n"), "unknown_defect");
  EXPECT_EQ(code("fruit,defect,class\n3,1,crack\n"), "unknown_defect");
  EXPECT_EQ(code("defect,class\n1,crack\n"), "unknown_defect");  // of which fruit?
  for (const char* hostile : {"3", "{}", R"({"fruits": [3, {"defects": 1}], "id": []})"}) {
    Json json = Json::parse(hostile);
    EXPECT_TRUE(LabelReport({}, json).ok());
    EXPECT_FALSE(ReadLabelledReport(json).ok());
  }
}

}  // namespace
}  // namespace drupe
