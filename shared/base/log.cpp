#include "base/log.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "base/clock.h"
#include "base/trace.h"

namespace drupe {

namespace {

struct LogState {
  std::string service;
  bool json = false;
  std::shared_ptr<spdlog::logger> logger;
};

LogState& State() {
  static LogState state = [] {
    LogState initial;
    initial.logger = std::make_shared<spdlog::logger>("drupe", std::make_shared<spdlog::sinks::stderr_sink_mt>());
    initial.logger->set_pattern("%v");
    initial.logger->set_level(spdlog::level::warn);
    initial.logger->flush_on(spdlog::level::trace);
    return initial;
  }();
  return state;
}

spdlog::level::level_enum ToSpdlog(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug: return spdlog::level::debug;
    case LogLevel::kInfo: return spdlog::level::info;
    case LogLevel::kWarning: return spdlog::level::warn;
    case LogLevel::kError: return spdlog::level::err;
  }
  return spdlog::level::err;
}

std::string_view LevelName(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug: return "debug";
    case LogLevel::kInfo: return "info";
    case LogLevel::kWarning: return "warning";
    case LogLevel::kError: return "error";
  }
  return "error";
}

}  // namespace

void InitJsonLog(std::string_view service, LogLevel minimum) {
  LogState& state = State();
  state.service = service;
  state.json = true;
  state.logger->set_level(ToSpdlog(minimum));
}

void Log(LogLevel level, std::string_view message, std::initializer_list<std::pair<std::string_view, Json>> fields) {
  const LogState& state = State();
  if (!state.logger->should_log(ToSpdlog(level))) return;
  Json line;
  if (state.json) {
    line["time"] = FormatUtc(Clock::System().NowMs());
    line["level"] = LevelName(level);
    line["service"] = state.service;
    line["message"] = message;
    if (!CurrentTrace().empty()) line["trace"] = CurrentTrace();
  }
  for (const auto& [name, value] : fields) line[std::string(name)] = value;
  const std::string text =
      state.json ? DumpJson(line)
                 : std::string(LevelName(level)) + ": " + std::string(message) + (line.empty() ? "" : " " + DumpJson(line));
  state.logger->log(ToSpdlog(level), "{}", text);
}

}  // namespace drupe
