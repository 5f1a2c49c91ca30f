#include "capture/board/board_print.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/aruco.hpp>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <string>
#include <vector>

#include "scene/marker_dictionary.h"

namespace drupe {
namespace {

cv::Mat Decode(const std::string& png) {
  return cv::imdecode(std::vector<uchar>(png.begin(), png.end()), cv::IMREAD_GRAYSCALE);
}

struct Markers {
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;
};

Markers Detect(const cv::Mat& picture, const std::string& dictionary) {
  Markers markers;
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  cv::aruco::detectMarkers(picture, cv::aruco::getPredefinedDictionary(FindMarkerDictionary(dictionary)->opencv_id),
                           markers.corners, markers.ids, parameters);
  return markers;
}

TEST(BoardPrintTest, EveryMarkerIsFoundWhereBoardJsonSays) {
  constexpr double kDpi = 300, kDotsPerMm = kDpi / 25.4;
  const BoardPrintOptions options;
  const auto drawing = DrawBoard(options);
  ASSERT_TRUE(drawing.ok());
  const auto png = ToPng(*drawing, kDpi);
  ASSERT_TRUE(png.ok());
  const Markers markers = Detect(Decode(*png), options.dictionary);
  const Board board = BoardOf(options);
  const Eigen::Vector2d middle_mm(drawing->width_mm / 2, 10 + 52);
  std::set<int> found;
  for (std::size_t i = 0; i < markers.ids.size(); ++i) {
    if (!board.corners_mm.contains(markers.ids[i])) continue;  // the ruler's digits can pass for a small marker
    EXPECT_TRUE(found.insert(markers.ids[i]).second);
    const auto& corners = board.corners_mm.at(markers.ids[i]);
    for (int k = 0; k < 4; ++k) {  // the board's y points up, the page's down
      EXPECT_NEAR(markers.corners[i][k].x + 0.5, (middle_mm.x() + corners[k].x()) * kDotsPerMm, 0.6);
      EXPECT_NEAR(markers.corners[i][k].y + 0.5, (middle_mm.y() - corners[k].y()) * kDotsPerMm, 0.6);
    }
  }
  EXPECT_EQ(found.size(), 81U);
}

TEST(BoardPrintTest, OtherBoardsAreFoundToo) {
  for (const char* dictionary : {"DICT_5X5_100", "DICT_6X6_250", "DICT_APRILTAG_36h11"}) {
    const BoardPrintOptions options{.columns = 5, .rows = 3, .marker_mm = 15, .pitch_mm = 20, .dictionary = dictionary};
    const auto drawing = DrawBoard(options);
    ASSERT_TRUE(drawing.ok());
    const auto png = ToPng(*drawing, 200);
    ASSERT_TRUE(png.ok());
    EXPECT_EQ(Detect(Decode(*png), dictionary).ids.size(), 15U) << dictionary;
  }
}

TEST(BoardPrintTest, DotsKeepClearOfTheMarkers) {
  const auto drawing = DrawBoard({});
  ASSERT_TRUE(drawing.ok());
  EXPECT_GT(drawing->discs.size(), 2000U);
  const Board board = BoardOf({});
  const double cell = 8.0 / 6;
  for (const Disc& disc : drawing->discs) {
    EXPECT_GT(disc.x - disc.radius, 0);
    EXPECT_LT(disc.x + disc.radius, drawing->width_mm);
    for (const auto& [id, corners] : board.corners_mm) {
      const double dx = std::abs(disc.x - 62 - (corners[0].x() + 4)), dy = std::abs(62 - disc.y - (corners[0].y() - 4));
      ASSERT_GT(std::max(dx, dy) - 4 - disc.radius, 0.7 * cell) << id;
    }
  }
}

TEST(BoardPrintTest, TheSeedDecidesTheDots) {
  const std::string one = ToSvg(*DrawBoard({})), again = ToSvg(*DrawBoard({}));
  const std::string other = ToSvg(*DrawBoard({.seed = 2})), none = ToSvg(*DrawBoard({.speckle = false}));
  EXPECT_EQ(one, again);
  EXPECT_NE(one, other);
  EXPECT_EQ(none.find("<circle"), std::string::npos);
}

TEST(BoardPrintTest, SvgAndPngAreToScale) {
  const auto drawing = DrawBoard({});
  ASSERT_TRUE(drawing.ok());
  EXPECT_DOUBLE_EQ(drawing->width_mm, 124);
  const std::string svg = ToSvg(*drawing);
  EXPECT_NE(svg.find("width=\"124mm\" height=\"138mm\" viewBox=\"0 0 124 138\""), std::string::npos);
  EXPECT_NE(svg.find("M10.0000 10.0000h8.0000v1.3333h-8.0000z"), std::string::npos);  // the first marker's border
  const auto png = ToPng(*drawing, 254);                                              // 10 dots a mm, 10,000 a metre
  ASSERT_TRUE(png.ok());
  EXPECT_EQ(png->substr(37, 4), "pHYs");
  EXPECT_EQ(png->substr(41, 9), std::string("\0\0\x27\x10\0\0\x27\x10\x01", 9));
  const cv::Mat dots = Decode(*png);
  EXPECT_EQ(dots.cols, 1240);
  EXPECT_EQ(dots.rows, 1380);
  EXPECT_EQ(dots.at<uchar>(100, 100), 0);  // the first marker's first dot
  EXPECT_EQ(dots.at<uchar>(99, 99), 255);
  // The ruler's line, 100 mm and its own width long.
  int black = 0;
  for (int x = 0; x < dots.cols; ++x) black += dots.at<uchar>(1215, x) == 0 && dots.at<uchar>(1216, x) == 0 ? 1 : 0;
  EXPECT_EQ(black, 1002);
}

TEST(BoardPrintTest, PdfIsToScaleAndWhole) {
  const auto drawing = DrawBoard({});
  ASSERT_TRUE(drawing.ok());
  const std::string pdf = ToPdf(*drawing);
  EXPECT_EQ(pdf, ToPdf(*drawing));
  EXPECT_EQ(pdf.substr(0, 8), "%PDF-1.4");
  EXPECT_NE(pdf.find("/MediaBox [0 0 351.496063 391.181102]"), std::string::npos);  // 124 x 138 mm in points
  EXPECT_NE(pdf.find("10.0000 10.0000 8.0000 1.3333 re"), std::string::npos);       // the first marker's border
  // Every object begins where the table says, and the table where the end says.
  const std::size_t table = std::stoul(pdf.substr(pdf.rfind("startxref\n") + 10));
  ASSERT_EQ(pdf.substr(table, 4), "xref");
  std::size_t row = pdf.find("00000 n", table) - 11;
  for (int object = 1; object <= 5; ++object, row += 20) {
    const std::size_t at = std::stoul(pdf.substr(row, 10));
    EXPECT_EQ(pdf.substr(at, 7), std::to_string(object) + " 0 obj");
  }
  const std::size_t stream = pdf.find("stream\n") + 7;
  EXPECT_EQ(pdf.find("/Length " + std::to_string(pdf.find("endstream") - stream) + " "), pdf.find("/Length "));
}

TEST(BoardPrintTest, AMeasuredPrintScalesTheBoard) {
  const Board board = BoardOf({.measured_ruler_mm = 99});
  EXPECT_DOUBLE_EQ(board.corners_mm.at(0)[0].x(), -52 * 0.99);
}

TEST(BoardPrintTest, NamesTheOptionThatIsWrong) {
  const auto field = [](const BoardPrintOptions& options) { return DrawBoard(options).status().field(); };
  EXPECT_EQ(field({.columns = 0}), "columns");
  EXPECT_EQ(field({.columns = 16, .rows = 16}), "rows");  // 256 markers of 250
  EXPECT_EQ(field({.marker_mm = std::nan("")}), "marker_mm");
  EXPECT_EQ(field({.pitch_mm = 10}), "pitch_mm");
  EXPECT_EQ(field({.dictionary = "DICT_1X1"}), "dictionary");
  EXPECT_EQ(field({.measured_ruler_mm = 10}), "measured_ruler_mm");
  const auto drawing = DrawBoard({});
  EXPECT_EQ(ToPng(*drawing, 10).status().field(), "dpi");
  const auto large = DrawBoard({.columns = 40, .rows = 6, .marker_mm = 100, .pitch_mm = 150});
  ASSERT_TRUE(large.ok());
  EXPECT_EQ(ToPng(*large, 600).status().kind(), StatusKind::kTooLarge);
}

}  // namespace
}  // namespace drupe
