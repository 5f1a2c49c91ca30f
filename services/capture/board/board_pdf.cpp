#include <vector>

#include "capture/board/append_format.h"
#include "capture/board/board_print.h"

namespace drupe {
namespace {

constexpr double kPointsPerMm = 72 / 25.4;
constexpr double kHelveticaCapitals = 0.718;  // height of Helvetica's capitals in its size
constexpr double kArc = 0.5522847498;         // of a radius: control points of a quarter circle as a Bezier curve

/// Parentheses and backslashes have a meaning in a PDF string.
std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '(' || c == ')' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

void AppendDisc(const Disc& disc, std::string& page) {
  const double x = disc.x, y = disc.y, r = disc.radius, c = kArc * disc.radius;
  AppendFormat(page, "%.3f g %.4f %.4f m\n", disc.grey / 255.0, x + r, y);
  AppendFormat(page, "%.4f %.4f %.4f %.4f %.4f %.4f c\n", x + r, y + c, x + c, y + r, x, y + r);
  AppendFormat(page, "%.4f %.4f %.4f %.4f %.4f %.4f c\n", x - c, y + r, x - r, y + c, x - r, y);
  AppendFormat(page, "%.4f %.4f %.4f %.4f %.4f %.4f c\n", x - r, y - c, x - c, y - r, x, y - r);
  AppendFormat(page, "%.4f %.4f %.4f %.4f %.4f %.4f c f\n", x + c, y - r, x + r, y - c, x + r, y);
}

/// The page's drawing operators, in mm from the top left.
std::string PageOf(const BoardDrawing& drawing) {
  std::string page;
  AppendFormat(page, "%.8f 0 0 %.8f 0 %.6f cm\n", kPointsPerMm, -kPointsPerMm, drawing.height_mm * kPointsPerMm);
  for (const Disc& disc : drawing.discs) AppendDisc(disc, page);
  page += "0 g\n";
  for (const Rectangle& r : drawing.rectangles)
    AppendFormat(page, "%.4f %.4f %.4f %.4f re\n", r.x, r.y, r.width, r.height);
  page += "f\nBT\n";  // one fill, so that no renderer leaves hairlines between neighbouring cells
  for (const Label& label : drawing.labels) {
    AppendFormat(page, "/F1 %.3f Tf 1 0 0 -1 %.3f %.3f Tm\n", label.height_mm / kHelveticaCapitals, label.x, label.y);
    page += "(" + Escaped(label.text) + ") Tj\n";
  }
  return page + "ET\n";
}

/// Numbers the objects from 1 and adds the table of where they begin.
std::string FileOf(const std::vector<std::string>& objects) {
  std::string file = "%PDF-1.4\n";
  std::vector<std::size_t> offsets;
  for (const std::string& object : objects) {
    offsets.push_back(file.size());
    AppendFormat(file, "%zu 0 obj\n", offsets.size());
    file += object + "\nendobj\n";
  }
  const std::size_t table = file.size();
  AppendFormat(file, "xref\n0 %zu\n0000000000 65535 f \n", objects.size() + 1);
  for (const std::size_t offset : offsets) AppendFormat(file, "%010zu 00000 n \n", offset);
  AppendFormat(file, "trailer\n<< /Size %zu /Root 1 0 R >>\nstartxref\n%zu\n%%%%EOF\n", objects.size() + 1, table);
  return file;
}

}  // namespace

// Written by hand, since the drawing needs three operators: a library would bring fonts and the date into the file.
std::string ToPdf(const BoardDrawing& drawing) {
  const std::string page = PageOf(drawing);
  std::string sheet = "<< /Type /Page /Parent 2 0 R /Contents 4 0 R /Resources << /Font << /F1 5 0 R >> >> ";
  AppendFormat(sheet, "/MediaBox [0 0 %.6f %.6f] >>", drawing.width_mm * kPointsPerMm,
               drawing.height_mm * kPointsPerMm);
  std::string stream = "<< /Length " + std::to_string(page.size()) + " >>\nstream\n";
  stream += page + "endstream";
  return FileOf({"<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>",
                 "<< /Type /Pages /Kids [3 0 R] /Count 1 >>", sheet, stream,
                 "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>"});
}

}  // namespace drupe
