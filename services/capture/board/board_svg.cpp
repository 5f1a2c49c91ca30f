#include "capture/board/append_format.h"
#include "capture/board/board_print.h"

namespace drupe {
namespace {

constexpr double kSansSerifCapitals = 0.72;  // height of capitals in a sans-serif font's size

}  // namespace

std::string ToSvg(const BoardDrawing& drawing) {
  std::string svg = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  AppendFormat(svg,
               "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"%gmm\" height=\"%gmm\" "
               "viewBox=\"0 0 %g %g\">\n",
               drawing.width_mm, drawing.height_mm, drawing.width_mm, drawing.height_mm);
  AppendFormat(svg, "<rect width=\"%g\" height=\"%g\" fill=\"#fff\"/>\n<g>\n", drawing.width_mm, drawing.height_mm);
  for (const Disc& disc : drawing.discs) {
    AppendFormat(svg, "<circle cx=\"%.4f\" cy=\"%.4f\" r=\"%.4f\" fill=\"#%02x%02x%02x\"/>\n", disc.x, disc.y,
                 disc.radius, disc.grey, disc.grey, disc.grey);
  }
  // One path, so that no renderer leaves hairlines between neighbouring cells.
  svg += "</g>\n<path fill=\"#000\" d=\"\n";
  for (const Rectangle& r : drawing.rectangles) {
    AppendFormat(svg, "M%.4f %.4fh%.4fv%.4fh%.4fz\n", r.x, r.y, r.width, r.height, -r.width);
  }
  svg += "\"/>\n<g font-family=\"sans-serif\">\n";
  for (const Label& label : drawing.labels) {  // captions hold no characters that XML reserves
    AppendFormat(svg, "<text x=\"%.3f\" y=\"%.3f\" font-size=\"%.3f\">%s</text>\n", label.x, label.y,
                 label.height_mm / kSansSerifCapitals, label.text.c_str());
  }
  return svg + "</g>\n</svg>\n";
}

}  // namespace drupe
