#!/bin/bash
# packages.sh SOURCE BUILD: tools/package builds both packages, and lower versions of them to upgrade from (left for
# service.sh in BUILD/packages/older). lintian finds no error, manual pages are well-formed, completion completes, and
# what stillcut-dev holds is enough to build against.
set -eu
source=$1 build=$2 packages=$2/packages
fail() { echo "packages: $*" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

rm -rf "$packages"
"$source/tools/package" 0.0.1 > /dev/null
mkdir "$work/older"
mv "$packages"/*.deb "$work/older"
"$source/tools/package"
mv "$work/older" "$packages"
lintian --allow-root --fail-on error "$packages"/*.deb || fail "lintian ended with $?"

for package in "$packages"/*.deb; do dpkg-deb -x "$package" "$work/root"; done
for page in "$work"/root/usr/share/man/*/*.gz; do
  said=$(zcat "$page" | LC_ALL=C.UTF-8 groff -man -Tutf8 -ww -z 2>&1)
  [ -z "$said" ] || fail "$page: $said"
done
pages=("$work"/root/usr/share/man/man[18]/*.gz) programs=("$work"/root/usr/bin/*)
[ ${#pages[@]} = ${#programs[@]} ] || fail "${#programs[@]} programs have ${#pages[@]} manual pages"

completed() {  # completed WANTED WORD...: what is offered at the last word
  local wanted=$1 said
  shift
  said=$(bash -c '. "$0/$1"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _${1//-/_}; echo "${COMPREPLY[@]}"' \
    "$work/root/usr/share/bash-completion/completions" "$@")
  [ "$said" = "$wanted" ] || fail "completion of '$*' offers '$said', not '$wanted'"
}
completed 'replay' stillcut repl
completed '--scenario --shadow' stillcut hil --s
completed 'sdm zoa' stillcut lobes --method ''
completed '--priority' stillcutd --pri
completed '--shared-memory' stillcut-dds --sh
completed '4 12' stillcut-rsi --cycle-ms ''

# An integrator's program, with the package's files alone.
cat > "$work/integrator.cpp" << 'END'
#include <stillcut/correction_t.hpp>
#include <lcm/lcm-cpp.hpp>
int main() {
  stillcut::correction_t sent{}, heard{};
  sent.spindle_speed_rpm = 7560;
  sent.reason = "test";
  char bytes[1024];
  const int length = sent.encode(bytes, 0, sizeof bytes);
  return heard.decode(bytes, 0, length) == length && heard.spindle_speed_rpm == 7560 && heard.reason == "test" ? 0 : 1;
}
END
sed -i "s|/usr/include|$work/root/usr/include|" "$work/root/usr/share/pkgconfig/stillcut-messages.pc"
flags=$(PKG_CONFIG_PATH=$work/root/usr/share/pkgconfig pkg-config --cflags --libs stillcut-messages)
g++ -fno-strict-aliasing "$work/integrator.cpp" -o "$work/integrator" $flags
"$work/integrator" || fail 'a message does not come back as it was sent'
lcm-gen --python --ppath "$work" "$work"/root/usr/share/stillcut/messages/*.lcm
echo "packages: $(cd "$packages" && ls -s --block-size=1K *.deb | tr '\n' ' ')KiB"
