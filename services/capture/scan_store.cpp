#include "capture/scan_store.h"

#include "base/clock.h"

namespace drupe {
namespace {

const Migrations kScanSchema = {
    "CREATE TABLE scans (id TEXT PRIMARY KEY, created_ms INTEGER NOT NULL, origin_deg REAL, counters TEXT NOT NULL,"
    " camera TEXT NOT NULL, captured INTEGER NOT NULL, ended INTEGER NOT NULL, image_set TEXT NOT NULL,"
    " job TEXT NOT NULL, hand_over_error TEXT NOT NULL, timings TEXT NOT NULL);"
    "CREATE TABLE scan_frames (scan_id TEXT NOT NULL REFERENCES scans(id), view INTEGER NOT NULL, name TEXT NOT NULL,"
    " sha256 TEXT NOT NULL, bytes INTEGER NOT NULL, width INTEGER NOT NULL, height INTEGER NOT NULL,"
    " angle_deg REAL NOT NULL, taken_ms INTEGER NOT NULL, attempts INTEGER NOT NULL, check_json TEXT NOT NULL,"
    " sent INTEGER NOT NULL, PRIMARY KEY (scan_id, view));"};

Json JsonOrNull(const std::string& text) {
  if (text.empty()) return nullptr;
  const Result<Json> json = ParseJson(text);
  return json.ok() ? *json : Json();
}

ScanFrame FrameOf(const Statement& row) {
  ScanFrame frame;
  frame.view = static_cast<int>(row.Int(0));
  frame.name = row.Text(1), frame.sha256 = row.Text(2), frame.bytes = row.Int(3);
  frame.width = static_cast<int>(row.Int(4)), frame.height = static_cast<int>(row.Int(5));
  frame.angle_deg = row.Real(6), frame.taken_ms = row.Int(7), frame.attempts = static_cast<int>(row.Int(8));
  frame.check = JsonOrNull(row.Text(9)), frame.sent = row.Int(10) != 0;
  return frame;
}

void BindValue(Statement& statement, std::string_view value) {
  statement.Bind(value);
}
void BindValue(Statement& statement, double value) {
  statement.Bind(value);
}
void BindValue(Statement& statement, int value) {
  statement.Bind(value);
}

}  // namespace

Result<std::unique_ptr<ScanStore>> ScanStore::Open(Database& database) {
  DRUPE_RETURN_IF_ERROR(database.Migrate("scans", kScanSchema));
  return std::unique_ptr<ScanStore>(new ScanStore(database));
}

template <typename Value>
Status ScanStore::Set(const std::string& column, std::string_view id, const Value& value) {
  return database_.Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto update, database_.Prepare("UPDATE scans SET " + column + " = ? WHERE id = ?"));
    BindValue(*update, value);
    return update->Bind(id).Run();
  });
}

Status ScanStore::Begin(std::string_view id) {
  return database_.Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto insert,
                           database_.Prepare("INSERT INTO scans (id, created_ms, counters, camera, captured, ended,"
                                             " image_set, job, hand_over_error, timings)"
                                             " VALUES (?, ?, '', '', 0, 0, '', '', '', '')"
                                             " ON CONFLICT (id) DO NOTHING"));
    return insert->Bind(id).Bind(Clock::System().NowMs()).Run();
  });
}

Result<ScanRecord> ScanStore::Get(std::string_view id) {
  ScanRecord record;
  const Status status = database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto row, database_.Prepare("SELECT origin_deg, counters, camera, captured, ended,"
                                                             " image_set, job, hand_over_error, timings,"
                                                             " (SELECT MAX(taken_ms) FROM scan_frames"
                                                             " WHERE scan_id = id) FROM scans WHERE id = ?"));
    DRUPE_ASSIGN_OR_RETURN(const bool found, row->Bind(id).Step());
    if (!found) return NotFound("scan_not_found", "there is no scan " + std::string(id));
    record.id = id;
    if (!row->IsNull(0)) record.origin_deg = row->Real(0);
    record.counters = JsonOrNull(row->Text(1)), record.camera = JsonOrNull(row->Text(2));
    record.captured = row->Int(3) != 0, record.ended = row->Int(4) != 0;
    record.image_set = row->Text(5), record.job = row->Text(6), record.hand_over_error = row->Text(7);
    record.timings = JsonOrNull(row->Text(8)), record.last_shutter_ms = row->Int(9);
    return Status::Ok();
  });
  DRUPE_RETURN_IF_ERROR(status);
  return record;
}

Result<std::vector<ScanFrame>> ScanStore::Frames(std::string_view id) {
  std::vector<ScanFrame> frames;
  const Status status = database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto rows, database_.Prepare("SELECT view, name, sha256, bytes, width, height,"
                                                              " angle_deg, taken_ms, attempts, check_json, sent"
                                                              " FROM scan_frames WHERE scan_id = ? ORDER BY view"));
    rows->Bind(id);
    while (true) {
      DRUPE_ASSIGN_OR_RETURN(const bool more, rows->Step());
      if (!more) return Status::Ok();
      frames.push_back(FrameOf(*rows));
    }
  });
  DRUPE_RETURN_IF_ERROR(status);
  return frames;
}

Status ScanStore::SetOrigin(std::string_view id, double origin_deg) {
  return Set("origin_deg", id, origin_deg);
}

Status ScanStore::SetCamera(std::string_view id, const Json& camera, const Json& counters) {
  DRUPE_RETURN_IF_ERROR(Set("camera", id, std::string_view(DumpJson(camera))));
  return Set("counters", id, std::string_view(DumpJson(counters)));
}

Result<bool> ScanStore::AddFrame(std::string_view id, const ScanFrame& frame) {
  bool added = false;
  const Status status = database_.Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto insert,
                           database_.Prepare("INSERT INTO scan_frames (scan_id, view, name, sha256, bytes, width,"
                                             " height, angle_deg, taken_ms, attempts, check_json, sent)"
                                             " VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, 0)"
                                             " ON CONFLICT (scan_id, view) DO NOTHING RETURNING view"));
    insert->Bind(id).Bind(frame.view).Bind(frame.name).Bind(frame.sha256).Bind(frame.bytes).Bind(frame.width);
    insert->Bind(frame.height).Bind(frame.angle_deg).Bind(frame.taken_ms).Bind(frame.attempts);
    DRUPE_ASSIGN_OR_RETURN(added, insert->Bind(DumpJson(frame.check)).Step());
    while (added) {
      DRUPE_ASSIGN_OR_RETURN(const bool more, insert->Step());
      if (!more) break;
    }
    return Status::Ok();
  });
  DRUPE_RETURN_IF_ERROR(status);
  return added;
}

Status ScanStore::RemoveFrames(std::string_view id) {
  return database_.Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto erase, database_.Prepare("DELETE FROM scan_frames WHERE scan_id = ?"));
    return erase->Bind(id).Run();
  });
}

Status ScanStore::SetCaptured(std::string_view id) {
  return Set("captured", id, 1);
}

Result<std::vector<std::string>> ScanStore::Unfinished() {
  std::vector<std::string> ids;
  const Status status = database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto rows,
                           database_.Prepare("SELECT id FROM scans WHERE ended = 0 ORDER BY created_ms, id"));
    while (true) {
      DRUPE_ASSIGN_OR_RETURN(const bool more, rows->Step());
      if (!more) return Status::Ok();
      ids.push_back(rows->Text(0));
    }
  });
  DRUPE_RETURN_IF_ERROR(status);
  return ids;
}

Status ScanStore::SetImageSet(std::string_view id, std::string_view image_set) {
  DRUPE_RETURN_IF_ERROR(Set("image_set", id, image_set));
  if (!image_set.empty()) return Status::Ok();
  return database_.Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto update, database_.Prepare("UPDATE scan_frames SET sent = 0 WHERE scan_id = ?"));
    return update->Bind(id).Run();
  });
}

Status ScanStore::SetSent(std::string_view id, const ScanFrame& frame) {
  return database_.Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto update, database_.Prepare("UPDATE scan_frames SET sent = 1"
                                                                " WHERE scan_id = ? AND view = ? AND sha256 = ?"));
    return update->Bind(id).Bind(frame.view).Bind(frame.sha256).Run();
  });
}

Status ScanStore::SetJob(std::string_view id, std::string_view job) {
  return Set("job", id, job);
}
Status ScanStore::SetHandOverError(std::string_view id, std::string_view error) {
  return Set("hand_over_error", id, error);
}
Status ScanStore::SetTimings(std::string_view id, const Json& timings) {
  return Set("timings", id, std::string_view(DumpJson(timings)));
}
Status ScanStore::SetEnded(std::string_view id) {
  return Set("ended", id, 1);
}
Status ScanStore::Reopen(std::string_view id) {
  return Set("ended", id, 0);
}

Json ToJson(const ScanFrame& frame) {
  return {{"view", frame.view},           {"name", frame.name},
          {"sha256", frame.sha256},       {"bytes", frame.bytes},
          {"width", frame.width},         {"height", frame.height},
          {"angle_deg", frame.angle_deg}, {"taken_at", FormatUtc(frame.taken_ms)},
          {"attempts", frame.attempts},   {"check", frame.check},
          {"handed_over", frame.sent}};
}

}  // namespace drupe
