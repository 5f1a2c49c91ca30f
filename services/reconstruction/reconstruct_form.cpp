#include <algorithm>
#include <map>
#include <set>

#include "base/ids.h"
#include "http/multipart.h"
#include "reconstruction/reconstruct_request.h"

namespace drupe {

namespace {

/// Collects the parts of a form. At any time one part is in memory: a picture is verified and stored when it is
/// complete.
class FormSink : public PartSink {
 public:
  FormSink(ObjectStore& objects, const Limits& limits) : limits_(limits), intake_(objects, limits) {}

  Status BeginPart(const PartHead& head) override;
  Status WritePart(std::string_view bytes) override;
  Status EndPart() override;

  ImageIntake& intake() { return intake_; }
  const RequestDocuments& documents() const { return documents_; }

 private:
  Status BeginImage();
  Status BeginDocument();
  Json* DocumentOf(std::string_view name);

  const Limits limits_;
  const JsonLimits json_limits_;
  ImageIntake intake_;
  RequestDocuments documents_;
  std::set<std::string> image_names_;
  std::set<std::string> document_names_;
  PartHead head_;
  std::string bytes_;
  std::size_t max_bytes_ = 0;  ///< kept of the part; one byte more tells that it is too large
};

Status FormSink::BeginPart(const PartHead& head) {
  head_ = head;
  bytes_.clear();
  return head.name == "images" ? BeginImage() : BeginDocument();
}

Status FormSink::BeginImage() {
  max_bytes_ = limits_.max_image_bytes;
  DRUPE_RETURN_IF_ERROR(CheckImageName(head_.filename));
  if (!image_names_.insert(head_.filename).second) {
    return InvalidArgument("duplicate_name", "two images are called " + head_.filename, "images");
  }
  if (static_cast<int>(image_names_.size()) <= limits_.max_images) return Status::Ok();
  return Status(StatusKind::kTooLarge, "too_many_images",
                "a request has at most " + std::to_string(limits_.max_images) + " images", "images");
}

Status FormSink::BeginDocument() {
  max_bytes_ = json_limits_.max_bytes;
  if (DocumentOf(head_.name) == nullptr) {
    return InvalidArgument("unknown_part",
                           "there is no part \"" + head_.name + "\"; the parts are images, calibration, board, options",
                           head_.name);
  }
  if (document_names_.insert(head_.name).second) return Status::Ok();
  return InvalidArgument("duplicate_part", "the part " + head_.name + " comes twice", head_.name);
}

Json* FormSink::DocumentOf(std::string_view name) {
  if (name == "calibration") return &documents_.calibration;
  if (name == "board") return &documents_.board;
  return name == "options" ? &documents_.options : nullptr;
}

Status FormSink::WritePart(std::string_view bytes) {
  bytes_.append(bytes.substr(0, max_bytes_ + 1 - bytes_.size()));
  return Status::Ok();
}

Status FormSink::EndPart() {
  if (head_.name == "images") return intake_.Add(head_.filename, bytes_);
  const Result<Json> json = ParseJson(bytes_, json_limits_);
  if (!json.ok()) {
    return Status(json.status().kind(), json.status().code(), head_.name + ": " + json.status().message(), head_.name);
  }
  *DocumentOf(head_.name) = *json;
  return Status::Ok();
}

}  // namespace

Result<ReconstructRequest> ReadReconstructForm(const Request& http, ObjectStore& objects, ImageSetStore& sets,
                                               const Limits& limits) {
  FormSink sink(objects, limits);
  MultipartLimits multipart;
  multipart.max_parts = limits.max_images + 8;  // beyond the documents, room to name the part that is too many
  DRUPE_RETURN_IF_ERROR(ReadMultipart(http, sink, multipart));
  ReconstructRequest request;
  DRUPE_RETURN_IF_ERROR(sink.intake().Finish());
  request.images = sink.intake().images();
  request.refused_images = ToJson(sink.intake().refused());
  DRUPE_RETURN_IF_ERROR(ApplyDocuments(sink.documents(), request));
  DRUPE_ASSIGN_OR_RETURN(const ImageSet set, sets.CreateFrom(request.images));
  request.image_set = set.id;
  return request;
}

}  // namespace drupe
