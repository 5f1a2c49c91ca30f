#include "capture/calibration_store.h"

#include "base/clock.h"
#include "base/digest.h"

namespace drupe {
namespace {

const Migrations kCalibrationSchema = {
    "CREATE TABLE calibrations (id TEXT PRIMARY KEY, job TEXT NOT NULL, created_ms INTEGER NOT NULL,"
    " calibration TEXT NOT NULL, serial TEXT NOT NULL, lens TEXT NOT NULL, coverage_sha256 TEXT NOT NULL);"
    "CREATE INDEX calibrations_by_job ON calibrations (job);"};

}  // namespace

std::string CalibrationId(const Json& calibration, const CameraBinding& binding) {
  return "cal_" + Sha256Hex(DumpJson({{"calibration", calibration}, {"camera", ToJson(binding)}})).substr(0, 32);
}

Result<std::unique_ptr<CalibrationStore>> CalibrationStore::Open(Database& database) {
  DRUPE_RETURN_IF_ERROR(database.Migrate("calibrations", kCalibrationSchema));
  return std::unique_ptr<CalibrationStore>(new CalibrationStore(database));
}

Status CalibrationStore::Put(const StoredCalibration& calibration) {
  return database_.Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto insert,
                           database_.Prepare("INSERT INTO calibrations (id, job, created_ms, calibration, serial, lens,"
                                             " coverage_sha256) VALUES (?, ?, ?, ?, ?, ?, ?)"
                                             " ON CONFLICT (id) DO NOTHING"));
    const std::string text = DumpJson(calibration.calibration);
    insert->Bind(calibration.id).Bind(calibration.job).Bind(Clock::System().NowMs()).Bind(text);
    insert->Bind(calibration.binding.serial).Bind(calibration.binding.lens).Bind(calibration.coverage_sha256);
    return insert->Run();
  });
}

Result<StoredCalibration> CalibrationStore::Get(std::string_view id) {
  StoredCalibration stored;
  const Status status = database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto row,
                           database_.Prepare("SELECT id, job, calibration, serial, lens, coverage_sha256"
                                             " FROM calibrations WHERE id = ? OR job = ?"));
    DRUPE_ASSIGN_OR_RETURN(const bool found, row->Bind(id).Bind(id).Step());
    if (!found) return NotFound("calibration_not_found", "there is no calibration " + std::string(id), "calibration");
    stored.id = row->Text(0), stored.job = row->Text(1);
    DRUPE_ASSIGN_OR_RETURN(stored.calibration, ParseJson(row->Text(2)));
    stored.binding = {row->Text(3), row->Text(4)};
    stored.coverage_sha256 = row->Text(5);
    return Status::Ok();
  });
  DRUPE_RETURN_IF_ERROR(status);
  return stored;
}

}  // namespace drupe
