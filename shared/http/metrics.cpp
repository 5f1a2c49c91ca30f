#include "http/metrics.h"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <mutex>
#include <utility>
#include <vector>

namespace drupe {

namespace {

/// Bounds of the latency buckets, seconds: from a status question to an upload of two gigabytes.
const prometheus::Histogram::BucketBoundaries kSeconds = {0.001, 0.005, 0.02, 0.1, 0.5, 2, 10, 60, 300, 1200};

}  // namespace

struct Metrics::State {
  mutable std::mutex mutex;
  prometheus::Registry registry;
  std::map<std::string, prometheus::Family<prometheus::Counter>*> counters;
  std::map<std::string, prometheus::Family<prometheus::Histogram>*> histograms;
  std::vector<std::pair<prometheus::Gauge*, std::function<double()>>> gauges;
};

Metrics::Metrics() : state_(std::make_unique<State>()) {}
Metrics::~Metrics() = default;

void Metrics::Count(const std::string& name, const std::string& help, const Labels& labels, double amount) {
  const std::lock_guard lock(state_->mutex);
  auto& family = state_->counters[name];
  if (family == nullptr) family = &prometheus::BuildCounter().Name(name).Help(help).Register(state_->registry);
  family->Add(labels).Increment(amount);
}

void Metrics::ObserveSeconds(const std::string& name, const std::string& help, const Labels& labels, double seconds) {
  const std::lock_guard lock(state_->mutex);
  auto& family = state_->histograms[name];
  if (family == nullptr) family = &prometheus::BuildHistogram().Name(name).Help(help).Register(state_->registry);
  family->Add(labels, kSeconds).Observe(seconds);
}

void Metrics::AddGauge(const std::string& name, const std::string& help, std::function<double()> value) {
  const std::lock_guard lock(state_->mutex);
  auto& gauge = prometheus::BuildGauge().Name(name).Help(help).Register(state_->registry).Add({});
  state_->gauges.emplace_back(&gauge, std::move(value));
}

std::string Metrics::Text() const {
  const std::lock_guard lock(state_->mutex);
  for (const auto& [gauge, value] : state_->gauges) gauge->Set(value());
  return prometheus::TextSerializer().Serialize(state_->registry.Collect());
}

}  // namespace drupe
