#pragma once

#include "http/router.h"
#include "store/disk_object_store.h"

namespace drupe {

/// The longest piece of an upload that is taken at a time.
inline constexpr std::uint64_t kMaxUploadPieceBytes = std::uint64_t{16} << 20;

/// The store for other machines (RemoteObjectStore): GET /objects says whether there is room, GET, PUT and DELETE
/// /objects/SHA256 read, write and remove an object, PUT /object-roots/NAME says which ones a service refers to. A PUT
/// brings a piece, Content-Range: bytes FIRST-LAST/TOTAL, and what has arrived stays when the connection breaks;
/// without body, Content-Range: bytes */TOTAL, it asks how much has. All of them need the scope "store". `store` must
/// outlive the router.
void AddObjectRoutes(Router& router, DiskObjectStore& store);

}  // namespace drupe
