#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/status.h"
#include "scene/board.h"

namespace drupe {

/// What is printed.
struct BoardPrintOptions {
  int columns = 9;       ///< markers a row, 1..40
  int rows = 9;          ///< markers a column, 1..40
  double marker_mm = 8;  ///< side of a marker, 1..500
  double pitch_mm = 12;  ///< from one marker to the next; at least the marker and two cells of white
  std::string dictionary = "DICT_4X4_250";
  /// Dots between the markers: features for matching that turn with the fruit. They keep clear of the markers.
  bool speckle = true;
  std::uint64_t seed = 1;  ///< of the dots
  /// What the printed ruler measures where 100 mm were meant, 90..110: printers stretch. board.json is scaled by it.
  double measured_ruler_mm = 100;

  Status Check() const;
};

/// Shapes in mm, from the page's top left, y down.
struct Rectangle {  ///< black
  double x = 0, y = 0, width = 0, height = 0;
};
struct Disc {
  double x = 0, y = 0, radius = 0;
  int grey = 0;  ///< 0 black .. 255 white
};
/// One line of black text; (x, y) is where its base line starts.
struct Label {
  double x = 0, y = 0;
  double height_mm = 0;  ///< of capital letters
  std::string text;
};

/// A page of ink on white. No two rectangles overlap; discs may.
struct BoardDrawing {
  double width_mm = 0, height_mm = 0;
  std::vector<Disc> discs;
  std::vector<Rectangle> rectangles;
  std::vector<Label> labels;
};

/// The geometry of the board as it lies on the turntable once printed with these options.
Board BoardOf(const BoardPrintOptions& options);

/// Lays out markers, dots, a ruler of 100 mm (shorter on small boards) and a caption. Errors: 400 `invalid_option`.
Result<BoardDrawing> DrawBoard(const BoardPrintOptions& options);

/// SVG 1.1 whose unit is 1 mm.
std::string ToSvg(const BoardDrawing& drawing);

/// PDF 1.4, one page of the drawing's size, which asks viewers not to scale it. The same drawing gives the same bytes.
std::string ToPdf(const BoardDrawing& drawing);

/// 8-bit grey PNG at `dpi` (72..2400) dots an inch, with its resolution in the file and edges anti-aliased, so that
/// lengths are exact although dots are not. Errors: 400 `invalid_option`; 413 `image_too_large` beyond 400 million
/// dots.
Result<std::string> ToPng(const BoardDrawing& drawing, double dpi);

}  // namespace drupe
