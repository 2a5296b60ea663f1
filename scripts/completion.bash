# Completion for bash: `source scripts/completion.bash`; installed, it is there of itself. Completes the subcommands of
# silt, the options of silt and of scripts/* (as their --help has them), backends, keys of a case, and cases: directories with a case.toml
# and, for the scripts, Silt's own.

# The options that a command's --help names.
_silt_options() {
  "$@" --help 2>/dev/null | grep -oE -- '(^|[^a-z-])--?[a-z][a-z-]*' | grep -oE -- '--?[a-z][a-z-]*' | sort -u
}

# The keys of a case, as the program that is named or built here lists them.
_silt_keys() {
  local program=${COMP_WORDS[0]}
  [ "${program##*/}" = silt ] || program=${program%/*}/../build/release/bin/silt
  "$program" keys 2>/dev/null | cut -d ' ' -f 1 | sort -u
}

# Cases that begin with a word: directories, files, and the names given.
_silt_cases() {
  local word=$1 path
  shift
  for path in "$word"*/; do
    if [ -f "$path/case.toml" ]; then printf '%s\n' "${path%/}"; elif [ -d "$path" ]; then printf '%s\n' "$path"; fi
  done
  compgen -f -X '!*.toml' -- "$word"
  for path in "$@"; do
    if [ "${path#"$word"}" != "$path" ] || [ -z "$word" ]; then printf '%s\n' "$path"; fi
  done
}

# _silt_complete COMMAND...: what may follow a command; `names` are Silt's own cases. Names of files are never given to
# compgen -W, which carries out what is in them.
_silt_complete() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}
  case $before in
    --set|--vary) compopt -o nospace 2>/dev/null; mapfile -t COMPREPLY < <(compgen -S = -W "$(_silt_keys)" -- "$word"); return ;;
    --unset) mapfile -t COMPREPLY < <(compgen -W "$(_silt_keys)" -- "$word"); return ;;
    --backend) mapfile -t COMPREPLY < <(compgen -W "auto analytic bullet fcl" -- "$word"); return ;;
    --out|--checkpoint|--hostfile|--json) mapfile -t COMPREPLY < <(compgen -f -- "$word"); return ;;
  esac
  case $word in
    -*) mapfile -t COMPREPLY < <(compgen -W "$(_silt_options "$@")" -- "$word") ;;
    *) mapfile -t COMPREPLY < <(_silt_cases "$word" "${names[@]}") ;;
  esac
}

_silt() {
  local word=${COMP_WORDS[COMP_CWORD]} subcommands="run resume check info keys"
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "$subcommands --help --version" -- "$word")
  elif [ "${COMP_WORDS[1]}" = info ]; then
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  else
    local names=()
    _silt_complete "${COMP_WORDS[0]}" "${COMP_WORDS[1]}"
  fi
}

_silt_script() {
  local script=${COMP_WORDS[0]} names
  case $script in */*) ;; *) return ;; esac
  [ -f "${script%/*}/completion.bash" ] || return  # another command of that name
  names=("${script%/*}"/../cases/*/)
  names=("${names[@]%/}")
  names=("${names[@]##*/}")
  _silt_complete "$script"
}

complete -o filenames -F _silt silt
complete -o filenames -o default -F _silt_script run regress render plot report compare clean new-case surfaces submit sweep watch bench
