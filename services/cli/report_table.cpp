#include "cli/report_table.h"

#include <cstdarg>
#include <cstdio>

namespace drupe {

namespace {

/// printf into a string; lines of a table are short.
std::string Format(const char* format, ...) __attribute__((format(printf, 1, 2)));

std::string Format(const char* format, ...) {
  char line[256];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  return line;
}

std::string FruitLine(const Fruit& fruit, bool metric) {
  std::string line =
      Format("Fruit %d: %s, %zu defect%s, %.2f %% of the surface", fruit.id, DefectClassName(fruit.grade),
             fruit.defects.size(), fruit.defects.size() == 1 ? "" : "s", fruit.defect_area_pct);
  if (metric) {
    line += Format("; diameter %.2f x %.2f mm, surface %.0f mm2, volume %.0f mm3", fruit.equatorial_diameter_mm,
                   fruit.polar_diameter_mm, fruit.surface_area_mm2, fruit.volume_mm3);
  }
  return line + "\n";
}

std::string DefectLine(const Defect& defect) {
  return Format("%4d  %-10s %5.2f   %8.2f %8.2f %8.2f   %8.3f +- %-7.3f %8.3f   %6.3f\n", defect.id,
                DefectClassName(defect.defect_class), defect.confidence, defect.centre_mm.x(), defect.centre_mm.y(),
                defect.centre_mm.z(), defect.area_mm2, defect.area_uncertainty_mm2, defect.perimeter_mm,
                defect.roundness);
}

std::string ShareLine(const Fruit& fruit, const Defect& defect) {
  const double share = fruit.surface_area_mm2 > 0 ? 100.0 * defect.area_mm2 / fruit.surface_area_mm2 : 0.0;
  return Format("%4d  %-10s %5.2f   %7.3f %% of the surface   %6.3f\n", defect.id, DefectClassName(defect.defect_class),
                defect.confidence, share, defect.roundness);
}

}  // namespace

std::string ReportTable(const Report& report) {
  const bool metric = report.scale_source == ScaleSource::kBoard;
  if (report.fruits.empty()) return "No fruit found.\n";
  std::string table;
  for (const Fruit& fruit : report.fruits) {
    table += FruitLine(fruit, metric);
    if (fruit.defects.empty()) continue;
    table += metric
                 ? "  id  class      conf.   centre x, y, z (mm)          area (mm2)            perim.(mm)  roundness\n"
                 : "  id  class      conf.   area                       roundness\n";
    for (const Defect& defect : fruit.defects) table += metric ? DefectLine(defect) : ShareLine(fruit, defect);
  }
  return table;
}

}  // namespace drupe
