#include "http/buffered_form.h"

#include <utility>

namespace drupe {

Status BufferedForm::BeginPart(const PartHead& head) {
  head_ = head;
  bytes_.clear();
  DRUPE_ASSIGN_OR_RETURN(limit_, LimitOf(head));
  return Status::Ok();
}

Status BufferedForm::WritePart(std::string_view bytes) {
  bytes_.append(bytes.substr(0, limit_ + 1 - bytes_.size()));
  return Status::Ok();
}

Status BufferedForm::EndPart() {
  names_.insert(head_.name);
  return TakePart(head_, std::exchange(bytes_, {}));
}

Result<std::size_t> BufferedForm::OnlyOnce(const PartHead& head, std::size_t limit) const {
  if (!Has(head.name)) return limit;
  return InvalidArgument("duplicate_part", "the part " + head.name + " comes twice", head.name);
}

Status BufferedForm::UnknownPart(const PartHead& head, std::string_view known) {
  return InvalidArgument("unknown_part", "there is no part \"" + head.name + "\"; the parts are " + std::string(known),
                         head.name);
}

}  // namespace drupe
