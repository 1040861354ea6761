#!/usr/bin/env bash
# Installs stepscope, runs its checks, and reports them to the runner. action.yml sets the variables.
set -euo pipefail

version=${VERSION:-${ACTION_REF:-}}
temporary=${RUNNER_TEMP:-${TMPDIR:-/tmp}}/stepscope-action
rm -rf "$temporary"
mkdir -p "$temporary"

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
  if command -v sha256sum > /dev/null; then sha256sum "$1"; else shasum -a 256 "$1"; fi | cut -d ' ' -f 1
}

# Prints the folder of the program. Returns 1 if there is no release, 2 if it is damaged.
fetch() {
  local archive system
  system=$(target)
  if [ -z "$version" ] || [ -z "$system" ]; then return 1; fi
  archive=stepscope-${version#v}-$system.tar.gz
  for file in SHA256SUMS "$archive"; do
    curl --fail --silent --show-error --location --retry 3 --output "$temporary/$file" \
      "$RELEASES/$version/$file" || return 1
  done
  if [ "$(awk -v file="$archive" '$2 == file { print $1 }' "$temporary/SHA256SUMS")" != \
    "$(sha256 "$temporary/$archive")" ]; then
    echo "::error::$archive differs from SHA256SUMS of release $version" >&2
    return 2
  fi
  tar -xzf "$temporary/$archive" -C "$temporary" || return 2
  echo "$temporary/${archive%.tar.gz}/bin"
}

fetched=0
folder=$(fetch) || fetched=$?
case $fetched in
  0) ;;
  1)
    echo "There is no release for this runner; building stepscope from the action's sources." >&2
    cargo install --locked --quiet --path "$ACTION_PATH/cli" --root "$temporary"
    folder=$temporary/bin
    ;;
  *) exit 1 ;;
esac

mkdir -p "$REPORT"
junit=$REPORT/junit.xml
code=0
"$folder/stepscope" check "$CHECKS" --junit "$junit" --summary "$REPORT/summary.md" || code=$?

case $code in
  0) status=passed ;;
  3) status=failed ;;
  *) status=error ;;
esac
if [ -n "${GITHUB_OUTPUT:-}" ]; then
  printf 'status=%s\njunit=%s\n' "$status" "$junit" >> "$GITHUB_OUTPUT"
fi
if [ -n "${GITHUB_STEP_SUMMARY:-}" ] && [ -e "$REPORT/summary.md" ]; then
  cat "$REPORT/summary.md" >> "$GITHUB_STEP_SUMMARY"
fi

# The report has one line per check, with the file as its class.
plain() {
  sed 's/&quot;/"/g; s/&lt;/</g; s/&gt;/>/g; s/&amp;/\&/g; s/%/%25/g' <<< "$1"
}
pattern='<testcase classname="([^"]*)" name="([^"]*)" [^>]*><(failure|error) message="([^"]*)"'
if [ -e "$junit" ]; then
  while IFS= read -r line; do
    [[ $line =~ $pattern ]] || continue
    class=${BASH_REMATCH[1]} name=${BASH_REMATCH[2]} message=${BASH_REMATCH[4]}
    file=$(plain "$class" | sed 's/:/%3A/g; s/,/%2C/g')
    echo "::error file=$file::$(plain "$name"): $(plain "$message")"
  done < "$junit"
fi
exit "$code"
