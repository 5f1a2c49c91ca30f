# shellcheck shell=bash disable=SC2034,SC2154
# What deploy/up, deploy/down and deploy/demo know in common about the three services. Sourced, with the root as the
# working directory; $data is the directory that the caller works on.

# In the order of starting: each finds those before it ready.
services=(capture analysis reconstruction)

default_data=${DRUPE_DATA:-${XDG_STATE_HOME:-$HOME/.local/state}/drupe}

port_of() {
  case $1 in
    capture) echo "${DRUPE_CAPTURE_PORT:-8081}" ;;
    reconstruction) echo "${DRUPE_RECONSTRUCTION_PORT:-8082}" ;;
    analysis) echo "${DRUPE_ANALYSIS_PORT:-8083}" ;;
  esac
}

url_of() { echo "http://127.0.0.1:$(port_of "$1")"; }

pid_file() { echo "$data/run/$1.pid"; }
log_file() { echo "$data/log/$1.log"; }

# Prints the process id of a service that runs on $data; fails when none does. A process id that now belongs to another
# program does not count.
running_pid() {
  local pid
  pid=$(cat "$(pid_file "$1")" 2>/dev/null) || return 1
  [ -n "$pid" ] && [ "$(cat "/proc/$pid/comm" 2>/dev/null)" = "$(printf '%.15s' "drupe-$1")" ] && echo "$pid"
}

# Sends SIGTERM, waits for the drain, and only then insists.
stop_service() {
  local pid
  pid=$(running_pid "$1") || { rm -f "$(pid_file "$1")"; return 0; }
  kill -TERM "$pid" 2>/dev/null || true
  for _ in $(seq 300); do
    running_pid "$1" >/dev/null || break
    sleep 0.1
  done
  if running_pid "$1" >/dev/null; then
    echo "drupe-$1 ($pid) did not stop within 30 s; killing it. Its job is taken up again at the next start." >&2
    kill -KILL "$pid" 2>/dev/null || true
  fi
  rm -f "$(pid_file "$1")"
}
