#!/bin/bash
# emulated-tests.sh BUILD-ARM64 [CTEST-OPTIONS...]: what was built for arm64, run in QEMU: the unit tests and the comparison
# of decisions; all but those that not-emulated.txt names with the reason. A name there that is no test (any longer) is an
# error, and so is a test that did not run.
set -euf -o pipefail
arm64=$1
shift
here=$(dirname "$(readlink -f "$0")")
names=$arm64/arm64-tests.txt
ctest --test-dir "$arm64" -N -LE 'system|long' | sed -nE 's/^ *Test +#[0-9]+: //p' > "$names"
pattern=$(grep -v '^#' "$here/not-emulated.txt" | sed 's/ .*//' | paste -sd'|')
for test in ${pattern//|/ }; do
  grep -qxE "$test" "$names" || { echo "emulated-tests: not-emulated.txt names '$test', which is no test" >&2; exit 1; }
done
echo "emulated-tests: $(grep -c . "$names") tests, $(grep -cxE "$pattern" "$names") of them left out"
ctest --test-dir "$arm64" --output-on-failure --no-tests=error --timeout 3600 -LE 'system|long' -E "^($pattern)\$" "$@" |
  tee "$arm64/emulated-tests.log"
! grep -qE 'did not run|\(Not Run\)|\*\*\*Skipped' "$arm64/emulated-tests.log"
