#pragma once

#include <memory>
#include <string>

#include "jobs/fake_clock.h"
#include "jobs/job_store.h"

namespace drupe {

/// What job_store_conformance.cpp needs of a back end: a test of one compiles that file together with its own
/// MakeJobStoreUnderTest.
class JobStoreUnderTest {
 public:
  virtual ~JobStoreUnderTest() = default;
  virtual JobStore& store() = 0;
  FakeClock& clock() { return clock_; }

 protected:
  FakeClock clock_;
};

/// A new, empty store with those options on a clock that stands still; null when this machine cannot run the back end.
std::unique_ptr<JobStoreUnderTest> MakeJobStoreUnderTest(const JobStoreOptions& options);
/// Why MakeJobStoreUnderTest gives null.
std::string WhyNoJobStoreUnderTest();

}  // namespace drupe
