#pragma once

#include <vector>

#include "scene/report.h"

namespace drupe {

/// One fruit's part of the report: the traits with its defects, its grade (the worst class), the defects' shares of its
/// surface, and everything brought back from mm to the world's unit by 1 / mm_per_unit (1 with a metric scale).
Fruit AssembleFruit(Fruit traits, std::vector<Defect> defects, double mm_per_unit);

/// Numbers the fruits from 1, in the order given.
void NumberFruits(std::vector<Fruit>& fruits);

}  // namespace drupe
