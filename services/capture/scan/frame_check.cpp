#include "capture/scan/frame_check.h"

#include <algorithm>
#include <cmath>

#include "capture/scan/marker_count.h"
#include "capture/scan/small_picture.h"
#include "scene/marker_dictionary.h"

namespace drupe {
namespace {

constexpr int kCompareWidth = 160;
constexpr int kEnd = 254;  // of a channel: lens and codec move a saturated one by a level

/// Mean squares of the second differences along rows and along columns.
struct DetailEnergy {
  double horizontal = 0, vertical = 0;
};

DetailEnergy MeasureDetail(const GrayImage& image) {
  DetailEnergy energy;
  for (int y = 1; y + 1 < image.height(); ++y) {
    const std::uint8_t *above = image.Row(y - 1), *row = image.Row(y), *below = image.Row(y + 1);
    std::int64_t horizontal = 0, vertical = 0;
    for (int x = 1; x + 1 < image.width(); ++x) {
      const int h = 2 * row[x] - row[x - 1] - row[x + 1], v = 2 * row[x] - above[x] - below[x];
      horizontal += h * h, vertical += v * v;
    }
    energy.horizontal += static_cast<double>(horizontal), energy.vertical += static_cast<double>(vertical);
  }
  const double pixels = static_cast<double>(image.width()) * image.height();
  return {energy.horizontal / pixels, energy.vertical / pixels};
}

/// The worse of both directions: motion blurs along one of them.
double Sharpness(const GrayImage& image) {
  const DetailEnergy fine = MeasureDetail(image), coarse = MeasureDetail(Halve(image));
  const double horizontal = fine.horizontal / std::max(1e-6, coarse.horizontal);
  return std::min(horizontal, fine.vertical / std::max(1e-6, coarse.vertical));
}

double MeanDifference(const GrayImage& a, const GrayImage& b) {
  std::int64_t sum = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) sum += std::abs(int{a.At(x, y)} - b.At(x, y));
  }
  return static_cast<double>(sum) / (static_cast<double>(a.width()) * a.height());
}

double SaturatedPercent(const RgbImage& image) {
  std::int64_t count = 0;
  for (int y = 0; y < image.height(); ++y) {
    const std::uint8_t* p = image.Row(y);
    for (int x = 0; x < image.width(); ++x, p += 3) count += std::max({p[0], p[1], p[2]}) >= kEnd ? 1 : 0;
  }
  return 100.0 * static_cast<double>(count) / (static_cast<double>(image.width()) * image.height());
}

double LevelExceededByOnePercent(const GrayImage& image) {
  std::vector<std::int64_t> histogram(256);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) ++histogram[image.At(x, y)];
  }
  std::int64_t left = std::int64_t{image.width()} * image.height() / 100;
  int level = 255;
  while (level > 0 && (left -= histogram[level]) >= 0) --level;
  return level;
}

/// 0 while there are too few to tell.
double MedianOf(std::vector<double> values) {
  if (values.size() < 3) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Status FrameCheckOptions::Check() const {
  if (!(min_ratio >= 0 && min_ratio < 1)) {
    return InvalidArgument("invalid_option", "checks.min_ratio must be 0 to 1", "checks.min_ratio");
  }
  if (!(min_sharpness_ratio >= 0 && min_sharpness_ratio < 1)) {
    return InvalidArgument("invalid_option", "checks.min_sharpness_ratio must be 0 to 1", "checks.min_sharpness_ratio");
  }
  if (!(max_saturated_pct >= 0 && max_saturated_pct <= 100)) {
    return InvalidArgument("invalid_option", "checks.max_saturated_pct must be 0 to 100", "checks.max_saturated_pct");
  }
  if (min_markers < 0 || min_markers > 1000) {
    return InvalidArgument("invalid_option", "checks.min_markers must be 0 to 1000", "checks.min_markers");
  }
  if (dictionary.empty() || FindMarkerDictionary(dictionary) != nullptr) return Status::Ok();
  return InvalidArgument("invalid_option", "there is no dictionary " + dictionary, "board.dictionary");
}

Json ToJson(const FrameCheck& check) {
  return {{"sharpness", check.sharpness},
          {"saturated_pct", check.saturated_pct},
          {"bright_level", check.bright_level},
          {"motion_px", check.motion_px},
          {"change", check.change < 0 ? Json() : Json(check.change)},
          {"markers", check.markers < 0 ? Json() : Json(check.markers)},
          {"faults", check.faults}};
}

FrameCheck ParseFrameCheck(const Json& json) {
  FrameCheck check;
  const auto number = [&](const char* key, double fallback) {
    return json.contains(key) && json[key].is_number() ? json[key].get<double>() : fallback;
  };
  check.sharpness = number("sharpness", 0);
  check.saturated_pct = number("saturated_pct", 0);
  check.bright_level = number("bright_level", 0);
  check.motion_px = number("motion_px", 0);
  check.change = number("change", -1);
  check.markers = static_cast<int>(number("markers", -1));
  if (!json.contains("faults") || !json["faults"].is_array()) return check;
  for (const Json& fault : json["faults"]) {
    if (fault.is_string()) check.faults.push_back(fault.get<std::string>());
  }
  return check;
}

FrameCheck FrameInspector::Inspect(const RgbImage& image, double motion_px, bool turned) {
  const GrayImage gray = GrayOf(image);
  FrameCheck check;
  check.sharpness = Sharpness(gray);
  check.saturated_pct = SaturatedPercent(image);
  check.bright_level = LevelExceededByOnePercent(gray);
  check.motion_px = motion_px;
  GrayImage small = ShrinkTo(gray, kCompareWidth);
  if (last_small_.width() == small.width() && last_small_.height() == small.height()) {
    check.change = MeanDifference(small, last_small_);
  }
  last_small_ = std::move(small);
  if (!options_.dictionary.empty()) check.markers = CountMarkers(gray, options_.dictionary);
  Judge(check, turned);
  return check;
}

void FrameInspector::Remember(const FrameCheck& kept) {
  sharpness_.push_back(kept.sharpness);
  bright_.push_back(kept.bright_level);
  if (kept.change >= 0) change_.push_back(kept.change);
  if (kept.markers >= 0) markers_.push_back(kept.markers);
}

void FrameInspector::Judge(FrameCheck& check, bool turned) const {
  const auto least = [](double limit, double ratio, const std::vector<double>& kept) {
    return std::max(limit, ratio * MedianOf(kept));
  };
  const double ratio = options_.min_ratio;
  const auto add = [&check](bool fault, const char* name) {
    if (fault) check.faults.emplace_back(name);
  };
  add(check.sharpness < least(options_.min_first_sharpness, options_.min_sharpness_ratio, sharpness_), "blurred");
  add(check.saturated_pct > options_.max_saturated_pct, "saturated");
  add(check.bright_level < least(options_.min_bright_level, ratio, bright_), "dark");
  add(check.motion_px > options_.max_motion_px, "moved");
  add(turned && check.change >= 0 && check.change < least(options_.min_change, ratio, change_), "duplicate");
  add(check.markers >= 0 && check.markers < least(options_.min_markers, ratio, markers_), "no_board");
}

}  // namespace drupe
