#include "defect_analysis/report/assemble.h"

#include <algorithm>

namespace drupe {
namespace {

void Rescale(double unit, Defect& defect) {
  defect.centre_mm *= unit;
  defect.area_mm2 *= unit * unit;
  defect.area_uncertainty_mm2 *= unit * unit;
  defect.planar_area_mm2 *= unit * unit;
  for (double* length :
       {&defect.perimeter_mm, &defect.perimeter_uncertainty_mm, &defect.diameter_mm, &defect.diameter_uncertainty_mm,
        &defect.length_mm, &defect.width_mm, &defect.depth_mm, &defect.depth_uncertainty_mm}) {
    *length *= unit;
  }
  defect.plane.offset_mm *= unit;
  defect.plane.rms_mm *= unit;
  defect.plane.mean_abs_z_mm *= unit;
  for (Eigen::Vector3d& point : defect.contour_mm) point *= unit;
}

void Rescale(double unit, Fruit& fruit) {
  fruit.centre_mm *= unit;
  for (double* volume : {&fruit.volume_mm3, &fruit.volume_uncertainty_mm3}) *volume *= unit * unit * unit;
  for (double* area : {&fruit.surface_area_mm2, &fruit.surface_area_uncertainty_mm2}) *area *= unit * unit;
  for (double* length : {&fruit.equatorial_diameter_mm, &fruit.equatorial_uncertainty_mm, &fruit.polar_diameter_mm,
                         &fruit.polar_uncertainty_mm}) {
    *length *= unit;
  }
  for (Defect& defect : fruit.defects) Rescale(unit, defect);
}

}  // namespace

Fruit AssembleFruit(Fruit traits, std::vector<Defect> defects, double mm_per_unit) {
  Fruit fruit = std::move(traits);
  fruit.defects = std::move(defects);
  fruit.grade = DefectClass::kIntact;
  fruit.defect_area_pct = 0;
  for (Defect& defect : fruit.defects) {
    fruit.grade = std::max(fruit.grade, defect.defect_class);
    defect.area_share_pct = 100 * defect.area_mm2 / fruit.surface_area_mm2;
    fruit.defect_area_pct += defect.area_share_pct;
  }
  Rescale(1 / mm_per_unit, fruit);
  return fruit;
}

void NumberFruits(std::vector<Fruit>& fruits) {
  for (std::size_t k = 0; k < fruits.size(); ++k) fruits[k].id = static_cast<int>(k) + 1;
}

}  // namespace drupe
