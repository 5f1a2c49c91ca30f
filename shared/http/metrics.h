#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace drupe {

/// Counters and gauges of one service, shown at /metrics in Prometheus' text format. Safe to use from any thread.
class Metrics {
 public:
  using Labels = std::map<std::string, std::string>;

  Metrics();
  ~Metrics();

  /// Adds to a counter ("drupe_jobs_finished_total"), made when first used. One name has one help text and one set of
  /// label names; label values must come from a small fixed set, never from a request.
  void Count(const std::string& name, const std::string& help, const Labels& labels = {}, double amount = 1);
  /// Adds a duration in seconds to a histogram.
  void ObserveSeconds(const std::string& name, const std::string& help, const Labels& labels, double seconds);
  /// A gauge whose value is asked for whenever /metrics is read; `value` must be cheap and outlive the service.
  void AddGauge(const std::string& name, const std::string& help, std::function<double()> value);

  std::string Text() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace drupe
