#include "reconstruction/picture_matching.h"

#include <algorithm>
#include <memory>
#include <string_view>
#include <utility>

#include "reconstruction/derived_cache.h"
#include "reconstruction/matching/static_features.h"
#include "reconstruction/picture_features.h"
#include "scene/archive.h"
#include "scene/calibration.h"
#include "scene/view_graph_archive.h"

namespace drupe {
namespace {

std::string WritePair(KnownPair known) {
  ArchiveWriter writer;
  writer(known.matches);
  return writer.Take();
}

/// Nothing when the bytes are not those of that pair.
std::optional<KnownPair> ReadPair(std::string_view bytes, const ImagePair& pair) {
  KnownPair known;
  ArchiveReader reader(bytes);
  reader(known.matches);
  if (!reader.Complete() || (known.matches && known.matches->pair != pair)) return std::nullopt;
  return known;
}

std::string CommonOf(const ReconstructionInput& input, const Json& options, std::uint64_t seed) {
  return DerivedKey("pairs", {{"calibration", ToJson(*input.calibration)},
                              {"features", options["features"]},
                              {"matching", options["matching"]},
                              {"seed", seed}});
}

}  // namespace

/// A picture as matching needs it.
class PictureMatching::Looked {
 public:
  static Result<std::unique_ptr<Looked>> At(const PictureMatching& matching, std::size_t view) {
    auto looked = std::make_unique<Looked>();
    DRUPE_ASSIGN_OR_RETURN(looked->features_, FindFeatures(matching.pictures_[view], matching.input_, matching.options_,
                                                           matching.context_));
    DRUPE_ASSIGN_OR_RETURN(const std::vector<std::uint8_t> is_static, matching.FindStatic(view, looked->features_));
    looked->prepared_ = matching.matcher_.Prepare(looked->features_, is_static);
    return looked;
  }
  const PreparedPicture& prepared() const { return prepared_; }

 private:
  Features features_;
  PreparedPicture prepared_;  ///< refers to features_
};

PictureMatching::PictureMatching(std::span<const SourceImage> pictures, const ReconstructionInput& input,
                                 const ReconstructionOptions& options, const RunContext& context)
    : pictures_(pictures),
      input_(input),
      options_(options),
      context_(context),
      matcher_(input.calibration->camera, false, options.matching, context.seed),
      option_json_(ToJson(options)),
      common_(CommonOf(input, option_json_, context.seed)) {}

std::optional<KnownPair> PictureMatching::Known(const ImagePair& pair) const {
  const std::optional<std::string> key = PairKey(pair);
  const std::optional<std::string> bytes = key ? input_.cache->Find(*key) : std::nullopt;
  return bytes ? ReadPair(*bytes, pair) : std::nullopt;
}

Status PictureMatching::MatchAhead(std::size_t view, std::span<const std::size_t> others) const {
  std::unique_ptr<Looked> here;  // for all pairs, once one has to be matched
  for (const std::size_t other : others) {
    DRUPE_RETURN_IF_ERROR(context_.CheckCancelled());
    const ImagePair pair{static_cast<int>(std::min(view, other)), static_cast<int>(std::max(view, other))};
    const std::optional<std::string> key = PairKey(pair);
    if (!key) continue;
    const auto make = [&]() -> Result<std::string> {
      if (here == nullptr) {
        DRUPE_ASSIGN_OR_RETURN(here, Looked::At(*this, view));
      }
      DRUPE_ASSIGN_OR_RETURN(const std::unique_ptr<Looked> there, Looked::At(*this, other));
      const Looked& first = view < other ? *here : *there;
      const Looked& second = view < other ? *there : *here;
      return WritePair({matcher_.Match(first.prepared(), second.prepared(), pair)});
    };
    DRUPE_RETURN_IF_ERROR(input_.cache->FindOrMake(*key, make, context_).status());
  }
  return Status::Ok();
}

std::optional<Json> PictureMatching::StaticParameters(std::size_t view) const {
  Json digests = Json::array({pictures_[view].sha256});
  bool is_kept = IsCached(pictures_[view], input_);
  for (const std::size_t other : ComparedForStatic(view, pictures_.size())) {
    digests.push_back(pictures_[other].sha256);
    is_kept = is_kept && IsCached(pictures_[other], input_);
  }
  return is_kept ? std::optional(std::move(digests)) : std::nullopt;
}

std::optional<std::string> PictureMatching::PairKey(const ImagePair& pair) const {
  std::optional<Json> first = StaticParameters(static_cast<std::size_t>(pair.first));
  std::optional<Json> second = StaticParameters(static_cast<std::size_t>(pair.second));
  if (!first || !second) return std::nullopt;
  return DerivedKey("pair", {{"common", common_},
                             {"pair", {pair.first, pair.second}},
                             {"first", *std::move(first)},
                             {"second", *std::move(second)}});
}

Result<std::vector<std::uint8_t>> PictureMatching::FindStatic(std::size_t view, const Features& features) const {
  if (!options_.matching.drop_static) return std::vector<std::uint8_t>(features.size(), 0);
  const auto make = [&]() -> Result<std::string> {
    std::vector<Features> compared;
    for (const std::size_t other : ComparedForStatic(view, pictures_.size())) {
      DRUPE_ASSIGN_OR_RETURN(Features found, FindFeatures(pictures_[other], input_, options_, context_));
      compared.push_back(std::move(found));
    }
    const std::vector<std::uint8_t> is_static =
        FindStaticFeatures(features, compared, options_.matching.static_radius_px, options_.matching.static_min_share);
    return std::string(is_static.begin(), is_static.end());
  };
  const std::string key = DerivedKey("static", {{"common", common_}, {"pictures", *StaticParameters(view)}});
  DRUPE_ASSIGN_OR_RETURN(const std::string bytes, input_.cache->FindOrMake(key, make, context_));
  if (bytes.size() != features.size()) return Internal("bad_static", "kept flags are not those of the picture");
  return std::vector<std::uint8_t>(bytes.begin(), bytes.end());
}

}  // namespace drupe
