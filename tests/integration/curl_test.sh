#!/usr/bin/env bash
# The services as a user meets them: by deploy/up and curl alone, sharing one data directory. Prints "N passed, N failed".
#   DRUPE_BIN=build/release/bin tests/integration/curl_test.sh
set -euo pipefail
cd "$(dirname "$0")/../.."
preset=$(basename "$(dirname "${DRUPE_BIN:?names the directory of the programs}")")
sample=tests/data/plum-s
work=$(mktemp -d -t drupe-curl.XXXXXX)

# Held all three at once, so that they differ.
read -r DRUPE_CAPTURE_PORT DRUPE_RECONSTRUCTION_PORT DRUPE_ANALYSIS_PORT <<<"$(python3 -c '
import socket
held = [socket.socket() for _ in range(3)]
for port in held: port.bind(("127.0.0.1", 0))
print(*(port.getsockname()[1] for port in held))')"
export DRUPE_CAPTURE_PORT DRUPE_RECONSTRUCTION_PORT DRUPE_ANALYSIS_PORT
reconstruction=http://127.0.0.1:$DRUPE_RECONSTRUCTION_PORT
analysis=http://127.0.0.1:$DRUPE_ANALYSIS_PORT
capture=http://127.0.0.1:$DRUPE_CAPTURE_PORT
trap 'deploy/down --data "$work/data" >/dev/null 2>&1 || true; rm -rf "$work"' EXIT

passed=0 failed=0
# check WHAT EXPECTED ACTUAL
check() {
  if [ "$2" = "$3" ]; then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    printf 'FAILED %s: expected "%s", got "%s"\n' "$1" "$2" "$3"
  fi
}

# send CURL_ARGUMENT...: sets `status`; the body is in $work/body, the headers in $work/head.
send() {
  : >"$work/body"
  status=$(curl --silent --max-time 60 --output "$work/body" --dump-header "$work/head" --write-out '%{http_code}' "$@") || true
}

# field EXPRESSION: a value of the JSON body.
field() {
  python3 -c 'import json, sys; body = json.load(open(sys.argv[1])); print(eval(sys.argv[2], {"body": body}))' "$work/body" "$1"
}

header() { awk -v name="$1:" 'tolower($1) == name { sub(/\r$/, ""); print $2; exit }' "$work/head"; }

# refuse WHAT STATUS CODE CURL_ARGUMENT...
refuse() {
  send "${@:4}"
  check "$1: status" "$2" "$status"
  check "$1: code" "$3" "$(field 'body["error"]["code"]' 2>/dev/null || cat "$work/body")"
  check "$1: has a message" True "$(field 'len(body["error"]["message"]) > 10' 2>/dev/null || echo no)"
}

wait_for_end() {
  for _ in $(seq 600); do
    send "$reconstruction/reconstructions/$1"
    case $(field 'body["status"]') in succeeded | failed | cancelled) return 0 ;; esac
    sleep 0.2
  done
}

wait_for_report() {
  for _ in $(seq 300); do
    send "$analysis/reports/$1"
    [ "$status" = 202 ] || [ "$status" = 404 ] || return 0
    sleep 0.2
  done
}

deploy/up --data "$work/data" --preset "$preset" >"$work/up.log" 2>&1 || { cat "$work/up.log"; exit 1; }

# Health, readiness, metrics and the contract of every service.
for url in "$capture" "$reconstruction" "$analysis"; do
  for path in healthz readyz metrics openapi.yaml schemas/report.schema.json; do
    send "$url/$path"
    check "GET /$path" 200 "$status"
  done
done

# The sample at half resolution: quick.
images=()
for image in "$sample"/images/*.jpg; do images+=(-F "images=@$image"); done
half_size=("${images[@]}" -F "calibration=<$sample/calibration.json" -F "board=<$sample/board.json"
  -F 'options={"dense": {"level": 1}}')

send -H 'Idempotency-Key: curl-1' "${half_size[@]}" "$reconstruction/reconstruct"
check "POST /reconstruct" 202 "$status"
id=$(field 'body["id"]')
check "Location" "/reconstructions/$id" "$(header location | sed 's|^http://[^/]*||')"
send -H 'Idempotency-Key: curl-1' "${half_size[@]}" "$reconstruction/reconstruct"
check "the same request again is the same job" "$id" "$(field 'body["id"]')"

timeout 120 curl --silent --no-buffer "$reconstruction/reconstructions/$id/events" >"$work/events" || true
check "events tell progress and end" True "$(grep -q '"status":"succeeded"' <(tr -d ' ' <"$work/events") && echo True || tail -n 3 "$work/events")"
wait_for_end "$id"
check "reconstruction" succeeded "$(field 'body["status"]')"
check "registered" "36 of 36" "$(field 'str(body["quality"]["registered"]) + " of " + str(body["quality"]["of"])')"

send "$reconstruction/reconstructions/$id/artifacts/dense.ply"
check "dense.ply" 200 "$status"
check "dense.ply is a PLY file" ply "$(head -c 3 "$work/body")"
etag=$(header etag)
send -H "If-None-Match: $etag" "$reconstruction/reconstructions/$id/artifacts/dense.ply"
check "an unchanged artifact" 304 "$status"
send -H 'Range: bytes=0-2' "$reconstruction/reconstructions/$id/artifacts/dense.ply"
check "a range: status" 206 "$status"
check "a range: bytes" ply "$(cat "$work/body")"

wait_for_report "$id"
check "report" 200 "$status"
check "one fruit in mm" "1 mm" "$(field 'str(len(body["fruits"])) + " " + str(body["unit"])')"
check "its grade" rain_spot "$(field 'body["fruits"][0]["grade"]')"
send "$analysis/reports/$id.csv"
check "report as CSV" 200 "$status"
send "$analysis/reports?grade=rain_spot&limit=1"
check "reports by grade" "$id" "$(field 'body["reports"][0]["id"]')"

# Cancel.
send "${images[@]}" -F "calibration=<$sample/calibration.json" -F 'options={"analyze": false}' "$reconstruction/reconstruct"
cancelled=$(field 'body["id"]')
send -X DELETE "$reconstruction/reconstructions/$cancelled"
check "DELETE" True "$([ "$status" = 202 ] || [ "$status" = 200 ] && echo True || echo "$status")"
wait_for_end "$cancelled"
check "cancelled" cancelled "$(field 'body["status"]')"

# Bad input: each has its own status, code and message.
printf 'not a picture' >"$work/notes.jpg"
printf 'GIF89a\x01\x00\x01\x00\x00\x00\x00;' >"$work/animated.gif"
python3 - "$work/bomb.png" <<'PNG'
import struct, sys, zlib
def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
header = chunk(b"IHDR", struct.pack(">IIBBBBB", 30000, 30000, 8, 2, 0, 0, 0))
open(sys.argv[1], "wb").write(b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", zlib.compress(b"\0" * 30000000)) + chunk(b"IEND", b""))
PNG
head -c 20000 "$sample/images/00.jpg" >"$work/short.jpg"
python3 -c 'print("[" * 100000 + "]" * 100000)' >"$work/deep.json"
two=(-F "images=@$sample/images/00.jpg" -F "images=@$sample/images/01.jpg")
three=("${two[@]}" -F "images=@$sample/images/02.jpg")
post=$reconstruction/reconstruct
refuse "two pictures" 400 too_few_images "${two[@]}" "$post"
refuse "not a picture" 415 unsupported_image "${two[@]}" -F "images=@$work/notes.jpg" "$post"
refuse "a GIF" 415 unsupported_image "${two[@]}" -F "images=@$work/animated.gif" "$post"
refuse "a decompression bomb" 413 image_too_large "${two[@]}" -F "images=@$work/bomb.png" "$post"
refuse "a truncated picture" 422 bad_image "${two[@]}" -F "images=@$work/short.jpg" "$post"
refuse "deep JSON" 400 json_too_deep "${three[@]}" -F "options=<$work/deep.json" "$post"
refuse "an unknown option" 400 unknown_option "${three[@]}" -F 'options={"dens": {}}' "$post"
refuse "an option out of range" 400 invalid_option "${three[@]}" -F 'options={"dense": {"level": 99}}' "$post"
refuse "a name that climbs" 400 invalid_name "${two[@]}" -F "images=@$sample/images/02.jpg;filename=../../x.jpg" "$post"
refuse "chunked" 411 length_required -H 'Transfer-Encoding: chunked' -H 'Content-Type: application/json' -d '{}' "$post"
refuse "compressed" 415 unsupported_encoding -H 'Content-Encoding: gzip' -H 'Content-Type: application/json' -d '{}' "$post"
refuse "no pictures" 400 too_few_images -F "calibration=<$sample/calibration.json" "$post"
: >"$work/empty.jpg"
refuse "an empty file" 422 bad_image "${two[@]}" -F "images=@$work/empty.jpg" "$post"
refuse "a picture twice" 400 duplicate_name "${three[@]}" -F "images=@$sample/images/02.jpg" "$post"
refuse "an unknown part" 400 unknown_part "${three[@]}" -F 'calibratoin={}' "$post"
refuse "JSON that ends early" 400 invalid_json "${three[@]}" -F 'calibration={"width": 1280' "$post"
refuse "a calibration without a camera matrix" 400 invalid_calibration "${three[@]}" -F 'calibration={"width": 1280, "height": 720}' "$post"
sed 's/1280/1920/; s/720/1080/' "$sample/calibration.json" >"$work/other_size.json"
refuse "a calibration of another size" 422 calibration_size_mismatch "${three[@]}" -F "calibration=<$work/other_size.json" "$post"
refuse "a board without markers" 400 invalid_board "${three[@]}" -F 'board={"dictionary": "DICT_4X4_250"}' "$post"
refuse "an option of the wrong type" 400 invalid_option "${three[@]}" -F 'options={"dense": {"level": "high"}}' "$post"
refuse "neither multipart nor JSON" 415 unsupported_media_type -H 'Content-Type: text/plain' -d 'hello' "$post"
refuse "a multipart body that is cut" 400 invalid_multipart -H 'Content-Type: multipart/form-data; boundary=x' -d '--x' "$post"
refuse "a method that the route has not" 405 method_not_allowed -X PATCH "$post"
refuse "an unknown image set" 404 image_set_not_found -H 'Content-Type: application/json' -d '{"image_set": "set_aaaaaaaaaaaaaaaaaaaa"}' "$post"
refuse "a key with another request" 409 idempotency_key_reused -H 'Idempotency-Key: curl-1' "${images[@]}" "$post"
refuse "a cancel after the end" 409 job_finished -X DELETE "$reconstruction/reconstructions/$id"
refuse "an unknown reconstruction" 404 job_not_found "$reconstruction/reconstructions/rec_none"
refuse "an unknown report" 404 report_not_found "$analysis/reports/rec_none"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
