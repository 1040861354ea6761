#!/usr/bin/env bash
# Installs stepscope, runs its checks, and reports them to the runner. action.yml sets the variables.
set -euo pipefail

version=${VERSION:-${ACTION_REF:-}}
junit=$REPORT/junit.xml
summary=$REPORT/summary.md
status=error
# Later steps of a workflow can read the outputs, however the script ends.
outputs() {
  if [ -n "${GITHUB_OUTPUT:-}" ]; then
    printf 'status=%s\njunit=%s\n' "$status" "$junit" >> "$GITHUB_OUTPUT"
  fi
}
trap outputs EXIT

temporary=${RUNNER_TEMP:-${TMPDIR:-/tmp}}/stepscope-action
rm -rf "$temporary"
mkdir -p "$temporary" "$REPORT"
# A report of an earlier run must not be taken for this one's.
rm -f "$junit" "$summary"

# The target of the release for this runner; empty if there is none.
target() {
  case "${RUNNER_OS:-}-${RUNNER_ARCH:-}" in
    Linux-X64) echo x86_64-unknown-linux-musl ;;
    Linux-ARM64) echo aarch64-unknown-linux-musl ;;
    macOS-X64) echo x86_64-apple-darwin ;;
    macOS-ARM64) echo aarch64-apple-darwin ;;
    Windows-X64) echo x86_64-pc-windows-msvc ;;
  esac
}

sha256() {
  if command -v sha256sum > /dev/null; then sha256sum; else shasum -a 256; fi < "$1" | cut -d ' ' -f 1
}

# Prints the folder of the program. Returns 1 if there is no release, 2 if it is damaged, 3 if it can't be fetched.
fetch() {
  local archive system
  system=$(target)
  if [ -z "$version" ] || [ -z "$system" ]; then return 1; fi
  archive=stepscope-${version#v}-$system.tar.gz
  # Names without a folder: tar takes the colon of D:\ for that of a host.
  cd "$temporary" || return 3
  for file in SHA256SUMS "$archive"; do
    curl --fail --silent --show-error --location --retry 3 --output "$file" "$RELEASES/$version/$file" || return 3
  done
  if [ "$(awk -v file="$archive" '$2 == file { print $1 }' SHA256SUMS)" != "$(sha256 "$archive")" ]; then
    echo "::error::$archive differs from SHA256SUMS of release $version" >&2
    return 2
  fi
  if ! tar -xzf "$archive"; then
    echo "::error::$archive of release $version can't be unpacked" >&2
    return 2
  fi
  echo "$PWD/${archive%.tar.gz}/bin"
}

build() {
  local note="$1; building stepscope from the action's sources"
  # Those may be another version than the workflow asks for.
  if [ -n "${VERSION:-}" ] && [ "$VERSION" != "${ACTION_REF:-}" ]; then note="::warning::$note"; fi
  echo "$note" >&2
  if ! cargo install --locked --quiet --path "$ACTION_PATH/cli" --root "$temporary"; then
    echo "::error::stepscope can't be built; install Rust, or use a version that has a release for this runner" >&2
    exit 1
  fi
}

fetched=0
folder=$(fetch) || fetched=$?
case $fetched in
  0) ;;
  1) build "There is no release for this runner" && folder=$temporary/bin ;;
  3) build "Release $version can't be fetched" && folder=$temporary/bin ;;
  *) exit 1 ;;
esac

code=0
errors=$temporary/errors.txt
"$folder/stepscope" check "$CHECKS" --junit "$junit" --summary "$summary" 2> "$errors" || code=$?
cat "$errors" >&2

case $code in
  0) status=passed ;;
  3) status=failed ;;
esac
if [ -n "${GITHUB_STEP_SUMMARY:-}" ] && [ -e "$summary" ]; then
  cat "$summary" >> "$GITHUB_STEP_SUMMARY"
fi

# The text and the file of a workflow command.
message() {
  local text=${1//'%'/%25}
  text=${text//$'\r'/%0D}
  text=${text//$'\n'/%0A}
  printf '%s' "$text"
}
property() {
  message "$1" | sed 's/:/%3A/g; s/,/%2C/g'
}
# Text of the report.
plain() {
  sed 's/&quot;/"/g; s/&lt;/</g; s/&gt;/>/g; s/&amp;/\&/g' <<< "$1"
}

# The report has one line per check, with the file as its class; the file counts from the folder of the list.
lists=
case $CHECKS in */*) lists=${CHECKS%/*}/ ;; esac
pattern='<testcase classname="([^"]*)" name="([^"]*)" [^>]*><(failure|error) message="([^"]*)"'
if [ -e "$junit" ]; then
  while IFS= read -r line; do
    [[ $line =~ $pattern ]] || continue
    name=${BASH_REMATCH[2]} why=${BASH_REMATCH[4]}
    file=$(plain "${BASH_REMATCH[1]}")
    if [ -e "$lists$file" ]; then file=$lists$file; fi
    echo "::error file=$(property "$file")::$(message "$(plain "$name"): $(plain "$why")")"
  done < "$junit"
elif [ "$code" -ne 0 ]; then
  echo "::error file=$(property "$CHECKS")::$(message "$(< "$errors")")"
fi
exit "$code"
