# Completion for bash: `source scripts/completion.bash`; installed, it is there of itself. Completes the subcommands of
# silt, the options of silt and of scripts/* (as their --help has them), backends, and cases: directories with a case.toml
# and, for the scripts, Silt's own.

# The options that a command's --help names.
_silt_options() {
  "$@" --help 2>/dev/null | grep -oE -- '(^|[^a-z-])--?[a-z][a-z-]*' | grep -oE -- '--?[a-z][a-z-]*' | sort -u
}

# Cases that begin with a word: directories, files, and the names given.
_silt_cases() {
  local word=$1 path
  shift
  for path in "$word"*/; do
    if [ -f "$path/case.toml" ]; then echo "${path%/}"; elif [ -d "$path" ]; then echo "$path"; fi
  done
  compgen -f -X '!*.toml' -- "$word"
  compgen -W "$*" -- "$word"
}

# _silt_complete NAMES COMMAND...: what may follow a command.
_silt_complete() {
  local names=$1 word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}
  shift
  case $before in
    --backend) mapfile -t COMPREPLY < <(compgen -W "auto analytic bullet fcl" -- "$word"); return ;;
    --out|--checkpoint|--hostfile|--json) mapfile -t COMPREPLY < <(compgen -f -- "$word"); return ;;
  esac
  case $word in
    -*) mapfile -t COMPREPLY < <(compgen -W "$(_silt_options "$@")" -- "$word") ;;
    *) mapfile -t COMPREPLY < <(_silt_cases "$word" "$names") ;;
  esac
}

_silt() {
  local word=${COMP_WORDS[COMP_CWORD]} subcommands="run resume check info"
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "$subcommands --help --version" -- "$word")
  elif [ "${COMP_WORDS[1]}" = info ]; then
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  else
    _silt_complete "" "${COMP_WORDS[0]}" "${COMP_WORDS[1]}"
  fi
}

_silt_script() {
  local script=${COMP_WORDS[0]} folder
  case $script in */*) folder=$(dirname "$script") ;; *) return ;; esac
  [ -f "$folder/completion.bash" ] || return  # another command of that name
  _silt_complete "$(cd "$folder/../cases" 2>/dev/null && echo */ | tr -d /)" "$script"
}

complete -o filenames -F _silt silt
complete -o default -F _silt_script run regress render plot report compare clean new-case surfaces submit bench
