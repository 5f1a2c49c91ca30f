#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/json.h"
#include "base/limits.h"
#include "base/status.h"
#include "http/request.h"
#include "reconstruction/image_sets.h"
#include "reconstruction/intake.h"
#include "scene/board.h"
#include "scene/calibration.h"
#include "store/object_store.h"

namespace drupe {

/// What POST /reconstruct asks for, checked in every part.
struct ReconstructRequest {
  std::string image_set;
  std::vector<StoredImage> images;  ///< ascending by name
  Json refused_images = Json::array();
  std::optional<Calibration> calibration;
  std::optional<Board> board;
  Json options = Json::object();  ///< of RunReconstruction, as sent
  bool analyze = true;            ///< let the analysis service make the report
  Json analysis_options = Json::object();
  std::string webhook;  ///< called when the reconstruction has ended, and when its report has; empty: none
};

/// The JSON parts of a request; absent ones are null. Calibration and board may be JSON or, for the board, "default".
struct RequestDocuments {
  Json calibration, board, options;
};

/// Checks the documents and puts them into `request`. Among the options, "analyze" (boolean), "analysis" (the
/// options of the analysis service) and "webhook" (a URL, checked by Webhooks::Check) are for the service, the others
/// for RunReconstruction. Errors: 400 `invalid_calibration`, `invalid_board`, `invalid_option`, `unknown_option`.
Status ApplyDocuments(const RequestDocuments& documents, ReconstructRequest& request);

/// Reads multipart/form-data: parts `images` and at most one each of `calibration`, `board`, `options`. Pictures are
/// stored in `objects` as they arrive and made a set of `sets`. Errors: those of ReadMultipart, ImageIntake and
/// ApplyDocuments; 400 `unknown_part`, `duplicate_part`, `invalid_name`, `duplicate_name`; 413 `too_many_images`; 422
/// `calibration_size_mismatch`.
Result<ReconstructRequest> ReadReconstructForm(const Request& http, ObjectStore& objects, ImageSetStore& sets,
                                               const Limits& limits);

/// Reads {"image_set": ID, "calibration", "board", "options", "analyze"}; a document that is not there is the one that
/// was announced with the set. Errors: 400 `invalid_request`, `invalid_id`, `unknown_option`, `too_few_images`, 404
/// `image_set_not_found`, and those of ApplyDocuments.
Result<ReconstructRequest> ReadReconstructJson(const Request& http, ImageSetStore& sets, const Limits& limits);

/// Reads what a new image set announces, {"calibration", "board", "options"}, all optional and as in
/// ReadReconstructJson, from the body of `http`, which may be empty. Errors: 400 `unknown_option`, `invalid_request`,
/// and those of ApplyDocuments.
Result<Json> ReadAnnouncement(const Request& http);

/// The request that the set announces, without images.
Result<ReconstructRequest> AnnouncedRequest(const ImageSet& set);

/// The request as a job keeps it, and back. Errors of the way back: 500, since only this program writes it.
Json ToPayload(const ReconstructRequest& request);
Result<ReconstructRequest> FromPayload(const Json& payload);

}  // namespace drupe
