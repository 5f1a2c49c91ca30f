#include <array>
#include <cstdio>

#include "capture/board/board_print.h"

namespace drupe {
namespace {

constexpr double kCapitalShare = 0.72;  // height of capitals in a sans-serif font's size

template <typename... Values>
void Append(std::string& svg, const char* format, Values... values) {
  std::array<char, 320> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  svg += line.data();
}

}  // namespace

std::string ToSvg(const BoardDrawing& drawing) {
  std::string svg = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  Append(svg,
         "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"%gmm\" height=\"%gmm\" "
         "viewBox=\"0 0 %g %g\">\n",
         drawing.width_mm, drawing.height_mm, drawing.width_mm, drawing.height_mm);
  Append(svg, "<rect width=\"%g\" height=\"%g\" fill=\"#fff\"/>\n<g>\n", drawing.width_mm, drawing.height_mm);
  for (const Disc& disc : drawing.discs) {
    Append(svg, "<circle cx=\"%.4f\" cy=\"%.4f\" r=\"%.4f\" fill=\"#%02x%02x%02x\"/>\n", disc.x, disc.y, disc.radius,
           disc.grey, disc.grey, disc.grey);
  }
  // One path, so that no renderer leaves hairlines between neighbouring cells.
  svg += "</g>\n<path fill=\"#000\" d=\"\n";
  for (const Rectangle& r : drawing.rectangles) {
    Append(svg, "M%.4f %.4fh%.4fv%.4fh%.4fz\n", r.x, r.y, r.width, r.height, -r.width);
  }
  svg += "\"/>\n<g font-family=\"sans-serif\">\n";
  for (const Label& label : drawing.labels) {  // captions hold no characters that XML reserves
    Append(svg, "<text x=\"%.3f\" y=\"%.3f\" font-size=\"%.3f\">%s</text>\n", label.x, label.y,
           label.height_mm / kCapitalShare, label.text.c_str());
  }
  return svg + "</g>\n</svg>\n";
}

}  // namespace drupe
