# What the studies of this folder share; each sources it as its first step:
#   start_study NAME LAST_LINE_OF_HELP "$@"
# prints the help if asked for, makes the folder, sets $out (the folder), $short (1 with --short, else empty), $bin (the tools'
# folder), $programs (the studies' own programs) and $data (what is installed with them). Uses the installed tools: those
# beside the script, else those on the PATH.

start_study() {
  local name="$1" last_line="$2" script="${BASH_SOURCE[1]}"
  shift 2
  usage() { sed -n "2,${last_line}s/^# \{0,1\}//p" "$script"; }
  [ $# -ge 1 ] || { usage >&2; exit 2; }
  case "$1" in -h | --help) usage; exit 0 ;; esac
  out="$1" short=
  if [ $# -gt 1 ]; then
    case "$2 $# $(usage)" in
      "--short 2 "*"[--short]"*) short=1 ;;
      *) usage >&2; exit 2 ;;
    esac
  fi
  if [ -e "$out" ] && [ -n "$(ls -A -- "$out" 2>/dev/null || echo file)" ]; then
    echo "$name: $out is there already and not empty; give another folder" >&2
    exit 2
  fi
  bin="$(cd -- "$(dirname -- "$script")" && pwd)/../../bin"
  if [ ! -x "$bin/delta-identify" ]; then
    bin="$(dirname -- "$(command -v delta-identify || true)")"
    if [ "$bin" = . ]; then
      echo "$name: the tools are neither beside this script nor on the PATH; cmake --install brings both" >&2
      exit 2
    fi
  fi
  programs="$bin/../libexec/deltadyn"
  data="$bin/../share/deltadyn"
  mkdir -p -- "$out"
}

# Shows a command, and runs it.
run() { printf '$'; printf ' %s' "${@//$bin\//}"; printf '\n'; "$@"; }

# The same for a tool whose verdict (exit code 5: not to be trusted) is part of the study and does not end it.
judge() { run "$@" || { code=$?; [ "$code" = 5 ] || exit "$code"; }; }
