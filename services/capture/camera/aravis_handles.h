#pragma once

#include <memory>
#include <string>

#include "base/status.h"

extern "C" {
typedef struct _GError GError;
void g_object_unref(void* object);
}

namespace drupe {

struct GObjectUnref {
  void operator()(void* object) const { g_object_unref(object); }
};
template <typename T>
using GObjectPointer = std::unique_ptr<T, GObjectUnref>;

/// Takes the error of a call to Aravis, which frees it: OK when there is none; 503 `camera_lost` when the camera does
/// not answer, 503 `camera_busy` when somebody else controls it, else 422 `camera_refused` with its words.
class AravisError {
 public:
  ~AravisError();
  GError** out() { return &error_; }
  Status Take(const std::string& doing);

 private:
  GError* error_ = nullptr;
};

}  // namespace drupe
