#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/aruco.hpp>
#include <random>

#include "capture/board/board_print.h"
#include "scene/marker_dictionary.h"

namespace drupe {
namespace {

constexpr double kMarginMm = 10;
constexpr double kRulerHeightMm = 14;  // with its labels and the caption
constexpr double kLineMm = 0.2;
constexpr double kTextMm = 2.2;
constexpr double kQuietCells = 0.75;  // white around a marker, in its cells
constexpr double kDotsPerMm2 = 1.3;

Status InvalidOption(std::string message, std::string field) {
  return InvalidArgument("invalid_option", std::move(message), std::move(field));
}

double CellMm(const BoardPrintOptions& options) {
  return options.marker_mm / (FindMarkerDictionary(options.dictionary)->bits + 2);
}

/// One drawing being laid out.
class Layout {
 public:
  explicit Layout(const BoardPrintOptions& options) : options_(options) {
    drawing_.width_mm = (options.columns - 1) * options.pitch_mm + options.marker_mm + 2 * kMarginMm;
    drawing_.height_mm = (options.rows - 1) * options.pitch_mm + options.marker_mm + 2 * kMarginMm + kRulerHeightMm;
  }

  BoardDrawing Draw() {
    const auto dictionary = cv::aruco::getPredefinedDictionary(FindMarkerDictionary(options_.dictionary)->opencv_id);
    for (int id = 0; id < options_.columns * options_.rows; ++id) AddMarker(*dictionary, id);
    if (options_.speckle) AddDots();
    AddRuler();
    AddCaption();
    return std::move(drawing_);
  }

 private:
  double Left(int column) const { return kMarginMm + column * options_.pitch_mm; }
  double Top(int row) const { return kMarginMm + row * options_.pitch_mm; }
  double BoardBottom() const { return drawing_.height_mm - kMarginMm - kRulerHeightMm; }

  /// The black cells of a marker and its border, joined along rows.
  void AddMarker(const cv::aruco::Dictionary& dictionary, int id) {
    const double left = Left(id % options_.columns), top = Top(id / options_.columns), cell = CellMm(options_);
    cv::Mat cells;
    dictionary.drawMarker(id, dictionary.markerSize + 2, cells, 1);
    for (int row = 0; row < cells.rows; ++row) {
      for (int column = 0; column < cells.cols; ++column) {
        const int start = column;
        while (column < cells.cols && cells.at<uchar>(row, column) == 0) ++column;
        if (column == start) continue;
        drawing_.rectangles.push_back({left + start * cell, top + row * cell, (column - start) * cell, cell});
      }
    }
  }

  /// How far (x, y) lies outside the nearest marker; negative inside. Markers are squares, hence the larger axis
  /// counts.
  double DistanceToMarkers(double x, double y) const {
    const auto along = [&](double position, int count) {
      const double phase = (position - kMarginMm - options_.marker_mm / 2) / options_.pitch_mm;
      return std::abs(phase - std::clamp(std::round(phase), 0.0, count - 1.0)) * options_.pitch_mm;
    };
    return std::max(along(x, options_.columns), along(y, options_.rows)) - options_.marker_mm / 2;
  }

  void AddDots() {
    std::mt19937_64 random(options_.seed);
    const auto uniform = [&random](double from, double to) {  // the standard's distributions differ between libraries
      return from + (to - from) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    const double quiet = kQuietCells * CellMm(options_), border = kMarginMm / 2;
    const double right = drawing_.width_mm - border, bottom = BoardBottom() + border;
    const int tries = static_cast<int>(kDotsPerMm2 * (right - border) * (bottom - border));
    for (int i = 0; i < tries; ++i) {
      const double largest = 0.055 * options_.marker_mm;
      const Disc disc{uniform(border, right), uniform(border, bottom), uniform(0.3 * largest, largest),
                      static_cast<int>(uniform(10, 130))};
      if (DistanceToMarkers(disc.x, disc.y) > quiet + disc.radius) drawing_.discs.push_back(disc);
    }
  }

  int RulerMm() const {
    const double room = drawing_.width_mm - 2 * kMarginMm + 5;
    return std::clamp(static_cast<int>(room / 10) * 10, 10, 100);
  }

  /// Lines centred on whole millimetres; each tenth is longer and has its number.
  void AddRuler() {
    const double y = BoardBottom() + 0.75 * kMarginMm, left = (drawing_.width_mm - RulerMm()) / 2;
    drawing_.rectangles.push_back({left - kLineMm / 2, y, RulerMm() + kLineMm, kLineMm});
    for (int mm = 0; mm <= RulerMm(); ++mm) {
      const double length = mm % 10 == 0 ? 4 : mm % 5 == 0 ? 3 : 2;
      drawing_.rectangles.push_back({left + mm - kLineMm / 2, y + kLineMm, kLineMm, length});
      if (mm % 10 != 0) continue;
      const std::string number = std::to_string(mm);
      drawing_.labels.push_back(
          {left + mm - 0.4 * kTextMm * static_cast<double>(number.size()), y + 7, kTextMm, number});
    }
  }

  void AddCaption() {
    char text[160];
    std::snprintf(text, sizeof(text), "%dx%d %s, %g mm / %g mm. Print at 100 %%; ruler: %d mm", options_.columns,
                  options_.rows, options_.dictionary.c_str(), options_.marker_mm, options_.pitch_mm, RulerMm());
    drawing_.labels.push_back({kMarginMm, BoardBottom() + kMarginMm + 10, 0.8 * kTextMm, text});
  }

  const BoardPrintOptions& options_;
  BoardDrawing drawing_;
};

}  // namespace

Status BoardPrintOptions::Check() const {
  const MarkerDictionary* known = FindMarkerDictionary(dictionary);
  if (known == nullptr) return InvalidOption("there is no dictionary " + dictionary, "dictionary");
  if (columns < 1 || columns > 40) return InvalidOption("must be 1 to 40", "columns");
  if (rows < 1 || rows > 40) return InvalidOption("must be 1 to 40", "rows");
  const int largest = std::min(known->marker_count, 1000);
  if (columns * rows > largest) {
    return InvalidOption("columns times rows must be at most " + std::to_string(largest) + " with this dictionary",
                         "rows");
  }
  if (!(marker_mm >= 1 && marker_mm <= 500)) return InvalidOption("must be 1 to 500", "marker_mm");
  const double least = marker_mm + 2 * marker_mm / (known->bits + 2);
  if (!(pitch_mm >= least && pitch_mm <= 1000)) {
    return InvalidOption("must be " + std::to_string(least) + " (the marker and two cells) to 1000", "pitch_mm");
  }
  if (!(measured_ruler_mm >= 90 && measured_ruler_mm <= 110)) {
    return InvalidOption("must be 90 to 110", "measured_ruler_mm");
  }
  return Status::Ok();
}

Board BoardOf(const BoardPrintOptions& options) {
  const double scale = options.measured_ruler_mm / 100;
  return MakeGridBoard(options.columns, options.rows, options.marker_mm * scale, options.pitch_mm * scale,
                       options.dictionary);
}

Result<BoardDrawing> DrawBoard(const BoardPrintOptions& options) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  try {
    return Layout(options).Draw();
  } catch (const std::exception& error) {
    return Internal("board_drawing_failed", error.what());
  }
}

}  // namespace drupe
