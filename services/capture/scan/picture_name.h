#pragma once

#include <cstdio>
#include <string>

namespace drupe {

/// What the rig calls its pictures in their order, 0 to 999: "007.jpg".
inline std::string PictureName(int number) {
  char name[16];
  std::snprintf(name, sizeof(name), "%03d.jpg", number);
  return name;
}

}  // namespace drupe
