#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/json.h"
#include "base/status.h"
#include "scene/fruit_truth.h"
#include "scene/report.h"

namespace drupe {

/// The true fruits of a truth.json. Errors: 400 `bad_truth`.
Result<std::vector<FruitTruth>> ParseFruitTruths(const Json& truth);

/// What is counted for the defects of one class.
struct ClassScore {
  int of = 0;                       ///< true defects
  int found = 0;                    ///< a reported defect lies there
  int class_right = 0;              ///< of those found
  std::vector<double> area_errors;  ///< relative, one a found defect
  int area_covered = 0;             ///< found ones whose true area lies within 2 u
  int perimeters = 0;               ///< found ones whose true perimeter is known
  int perimeter_covered = 0;        ///< and lies within 2 u
};

/// Reports held against the truth, over any number of fruits.
class DefectScores {
 public:
  /// Every reported fruit belongs to the true one whose centre is nearest, within 8 mm; a defect is found when the
  /// nearest one not yet used lies within 0.7 of the radius of a disc of its area (more for long ones), but at least
  /// 0.8 mm: as the project's evaluation does. `label` leads the notes.
  void Add(const std::string& label, const std::vector<FruitTruth>& truths, const std::vector<Fruit>& reported);

  /// The figures as a table and lines for a terminal.
  std::string Text() const;
  /// One line for each miss, false defect, wrong class, wrong grade and area outside 3 u and 5 %.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  void AddFruit(const std::string& label, const FruitTruth& truth, const Fruit& fruit);
  void AddDefect(const std::string& label, const TrueDefect& truth, const Defect* found);

  std::array<ClassScore, 5> by_class_;  ///< by DefectClass
  ClassScore touching_;                 ///< those that touch another, whatever their class
  std::array<ClassScore, 3> by_tone_;   ///< those darker than the skin, paler, and of another hue only
  int fruits_ = 0, fruits_found_ = 0, grades_right_ = 0, false_ = 0, intact_ = 0, false_on_intact_ = 0;
  int diameters_covered_ = 0, volumes_covered_ = 0;
  std::vector<double> volume_errors_, surface_errors_, diameter_errors_;
  std::vector<std::string> notes_;
};

}  // namespace drupe
