#include "cli/bench/defect_scores.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "cli/bench/text_table.h"

namespace drupe {

namespace {

constexpr double kFruitReach = 8;  // mm between the centres of a true fruit and its report
constexpr std::array kClasses = {DefectClass::kRainSpot, DefectClass::kScar, DefectClass::kCrack, DefectClass::kDecay};

constexpr std::array kTones = {"darker", "paler", "of another hue"};

// Place in kTones for a step in L from the skin to a defect.
std::size_t ToneOf(double lightness_step) {
  constexpr double kVisible = 6;  // a step that is one at a glance
  if (std::abs(lightness_step) < kVisible) return 2;
  return lightness_step < 0 ? 0 : 1;
}

Eigen::Vector3d VectorOf(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

DefectClass ClassOf(const std::string& name) {
  const auto found =
      std::find_if(kClasses.begin(), kClasses.end(), [&](DefectClass c) { return name == DefectClassName(c); });
  return found == kClasses.end() ? DefectClass::kIntact : *found;
}

FruitTruth ParseFruit(const Json& json) {
  FruitTruth fruit;
  fruit.centre_mm = VectorOf(json.at("centre_mm"));
  fruit.volume_mm3 = json.value("volume_mm3", 0.0);
  fruit.surface_area_mm2 = json.value("surface_area_mm2", 0.0);
  for (const Json& item : json.at("defects")) {
    TrueDefect defect;
    defect.defect_class = ClassOf(item.at("class").get<std::string>());
    defect.centre_mm = VectorOf(item.at("centre_mm"));
    defect.area_mm2 = item.at("area_mm2").get<double>();
    defect.stretch = item.value("stretch", 1.0);
    fruit.grade = std::max(fruit.grade, defect.defect_class);
    fruit.defects.push_back(defect);
  }
  return fruit;
}

double ReachOf(const TrueDefect& defect) {
  return std::max(0.8, 0.7 * std::sqrt(defect.area_mm2 / std::numbers::pi) * std::sqrt(std::max(1.0, defect.stretch)));
}

std::string Percent(double share, int decimals) {
  return FixedText(100 * share, decimals) + " %";
}

double MedianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

std::string Share(int part, int of) {
  return std::to_string(part) + "/" + std::to_string(of);
}

std::vector<std::string> RowOf(const std::string& name, const ClassScore& score) {
  std::vector<double> errors = score.area_errors;
  const double worst = errors.empty() ? 0 : *std::max_element(errors.begin(), errors.end());
  return {name,
          std::to_string(score.of),
          std::to_string(score.found),
          std::to_string(score.class_right),
          Percent(MedianOf(errors), 2),
          Percent(worst, 1),
          Share(score.area_covered, score.found),
          Share(score.perimeter_covered, score.perimeters)};
}

void Count(const TrueDefect& truth, const Defect* found, ClassScore& score) {
  ++score.of;
  if (found == nullptr) return;
  ++score.found;
  score.class_right += found->defect_class == truth.defect_class ? 1 : 0;
  const double error = std::abs(found->area_mm2 - truth.area_mm2);
  score.area_errors.push_back(error / truth.area_mm2);
  score.area_covered += error <= 2 * found->area_uncertainty_mm2 ? 1 : 0;
  if (truth.perimeter_mm <= 0) return;
  ++score.perimeters;
  score.perimeter_covered +=
      std::abs(found->perimeter_mm - truth.perimeter_mm) <= 2 * found->perimeter_uncertainty_mm ? 1 : 0;
}

void AddError(double measured, double truth, std::vector<double>& errors) {
  if (truth > 0) errors.push_back(std::abs(measured / truth - 1));
}

std::string Spread(const char* name, const std::vector<double>& errors) {
  if (errors.empty()) return "";
  return std::string(name) + " error median " + Percent(MedianOf(errors), 2) + ", worst " +
         Percent(*std::max_element(errors.begin(), errors.end()), 2) + "\n";
}

}  // namespace

Result<std::vector<FruitTruth>> ParseFruitTruths(const Json& truth) {
  try {
    std::vector<FruitTruth> fruits;
    if (!truth.contains("fruits")) return std::vector<FruitTruth>{ParseFruit(truth)};
    for (const Json& fruit : truth.at("fruits")) fruits.push_back(ParseFruit(fruit));
    return fruits;
  } catch (const std::exception& error) {
    return InvalidArgument("bad_truth", std::string("truth.json has no fruits as a rendered set has: ") + error.what());
  }
}

void DefectScores::Add(const std::string& label, const std::vector<FruitTruth>& truths,
                       const std::vector<Fruit>& reported) {
  for (std::size_t k = 0; k < truths.size(); ++k) {
    const FruitTruth& truth = truths[k];
    const auto away = [&](const Fruit& fruit) { return (fruit.centre_mm - truth.centre_mm).norm(); };
    const auto nearest = std::min_element(reported.begin(), reported.end(),
                                          [&](const Fruit& a, const Fruit& b) { return away(a) < away(b); });
    const std::string name = truths.size() == 1 ? label : label + " fruit " + std::to_string(k + 1);
    ++fruits_;
    if (nearest == reported.end() || away(*nearest) > kFruitReach) {
      notes_.push_back(name + ": not found");
      for (const TrueDefect& defect : truth.defects) AddDefect(name, defect, nullptr);
    } else {
      AddFruit(name, truth, *nearest);
    }
  }
}

void DefectScores::AddFruit(const std::string& label, const FruitTruth& truth, const Fruit& fruit) {
  ++fruits_found_;
  std::vector<std::uint8_t> used(fruit.defects.size(), 0);
  for (const TrueDefect& defect : truth.defects) {
    std::size_t best = used.size();
    double nearest = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < used.size(); ++i) {
      const double away = (fruit.defects[i].centre_mm - defect.centre_mm).norm();
      if (used[i] == 0 && away < nearest) {
        best = i;
        nearest = away;
      }
    }
    const bool found = nearest < ReachOf(defect);
    if (found) used[best] = 1;
    AddDefect(label, defect, found ? &fruit.defects[best] : nullptr);
  }
  const auto extra = static_cast<int>(std::count(used.begin(), used.end(), 0));
  false_ += extra;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] != 0) continue;
    notes_.push_back(label + ": false " + DefectClassName(fruit.defects[i].defect_class) + " of " +
                     FixedText(fruit.defects[i].area_mm2, 2) + " mm2");
  }
  if (truth.defects.empty()) {
    ++intact_;
    false_on_intact_ += extra;
  }
  grades_right_ += fruit.grade == truth.grade ? 1 : 0;
  if (fruit.grade != truth.grade) {
    notes_.push_back(label + ": grade " + DefectClassName(fruit.grade) + ", true " + DefectClassName(truth.grade));
  }
  AddError(fruit.volume_mm3, truth.volume_mm3, volume_errors_);
  AddError(fruit.surface_area_mm2, truth.surface_area_mm2, surface_errors_);
  AddError(fruit.equatorial_diameter_mm, truth.equatorial_diameter_mm, diameter_errors_);
  volumes_covered_ += std::abs(fruit.volume_mm3 - truth.volume_mm3) <= 2 * fruit.volume_uncertainty_mm3 ? 1 : 0;
  diameters_covered_ +=
      std::abs(fruit.equatorial_diameter_mm - truth.equatorial_diameter_mm) <= 2 * fruit.equatorial_uncertainty_mm ? 1
                                                                                                                   : 0;
}

void DefectScores::AddDefect(const std::string& label, const TrueDefect& truth, const Defect* found) {
  Count(truth, found, by_class_[static_cast<std::size_t>(truth.defect_class)]);
  if (truth.touching) Count(truth, found, touching_);
  if (truth.lightness_step) Count(truth, found, by_tone_[ToneOf(*truth.lightness_step)]);
  const std::string name = label + ": " + (truth.touching ? "touching " : "") + DefectClassName(truth.defect_class) +
                           " of " + FixedText(truth.area_mm2, 2) + " mm2";
  if (found == nullptr) {
    notes_.push_back(name + " missed");
    return;
  }
  if (found->defect_class != truth.defect_class) {
    notes_.push_back(name + " called " + DefectClassName(found->defect_class));
  }
  const double error = found->area_mm2 / truth.area_mm2 - 1;
  if (std::abs(error) > 0.05 && std::abs(error) * truth.area_mm2 > 3 * found->area_uncertainty_mm2) {
    notes_.push_back(name + " measured " + FixedText(100 * error, 1) + " % off, u " +
                     Percent(found->area_uncertainty_mm2 / truth.area_mm2, 1));
  }
}

std::string DefectScores::Text() const {
  std::vector<std::vector<std::string>> rows;
  ClassScore all;
  for (const DefectClass c : kClasses) {
    const ClassScore& score = by_class_[static_cast<std::size_t>(c)];
    rows.push_back(RowOf(DefectClassName(c), score));
    all.of += score.of;
    all.found += score.found;
    all.class_right += score.class_right;
    all.area_errors.insert(all.area_errors.end(), score.area_errors.begin(), score.area_errors.end());
    all.area_covered += score.area_covered;
    all.perimeters += score.perimeters;
    all.perimeter_covered += score.perimeter_covered;
  }
  rows.push_back(RowOf("all", all));
  for (std::size_t tone = 0; tone < by_tone_.size(); ++tone) {
    if (by_tone_[tone].of > 0) rows.push_back(RowOf(kTones[tone], by_tone_[tone]));
  }
  if (touching_.of > 0) rows.push_back(RowOf("touching", touching_));
  std::string text = FormatTextTable(
      {"defects", "true", "found", "class right", "area error", "worst", "area in 2 u", "perimeter in 2 u"}, rows);
  text += "false " + std::to_string(false_) + " on " + std::to_string(fruits_) + " fruits, of them " +
          std::to_string(false_on_intact_) + " on " + std::to_string(intact_) + " intact ones\n";
  text += "fruits found " + Share(fruits_found_, fruits_) + ", grade right " + Share(grades_right_, fruits_) +
          ", volume in 2 u " + Share(volumes_covered_, fruits_) + "\n";
  text += Spread("volume", volume_errors_) + Spread("surface area", surface_errors_);
  if (!diameter_errors_.empty()) {
    text += Spread("equatorial diameter", diameter_errors_) + "equatorial diameter in 2 u " +
            Share(diameters_covered_, fruits_) + "\n";
  }
  return text;
}

}  // namespace drupe
