# shellcheck shell=bash disable=SC2154
# Bash completion of ./robocop. `./robocop completion` prints it after the values of:
#   _robocop_root       the checkout, whose worlds and models are listed at each completion
#   _robocop_options    the options of each command
#   _robocop_arguments  the launch arguments of those that have some

# Launch arguments with their values: $1 is the word so far, NAME or NAME:=VALUE; $2 the command.
_robocop_launch_arguments() {
  local values="" start=${1%"${1##*[:=]}"}
  if [[ $1 != *:=* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "${_robocop_arguments[$2]}" -- "$1")
    COMPREPLY=("${COMPREPLY[@]#"$start"}")
    compopt -o nospace
    return
  fi
  case ${1%%:=*} in
    world) values="random $(cd "$_robocop_root/worlds" && printf '%s ' *.sdf)" ;;
    model) values=$(cd "$_robocop_root/config/models" && printf '%s ' *.yaml) ;;
  esac
  values=${values//.sdf/} values=${values//.yaml/}
  mapfile -t COMPREPLY < <(compgen -W "$values" -- "${1#*:=}")
  [ "${1%%:=*}" != model ] || return  # the others may be paths
  mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -f -- "${1#*:=}")
  compopt -o filenames
}

_robocop() {
  # Readline splits words at : and =, so the word is taken from the line; it replaces only what follows the last of them.
  local line=${COMP_LINE:0:COMP_POINT} command=${COMP_WORDS[1]} word
  word=${line##*[[:space:]]}
  COMPREPLY=()
  if [ "$COMP_CWORD" = 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "${!_robocop_options[*]}" -- "$word")
  elif [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "${_robocop_options[$command]:-}" -- "$word")
  elif [[ -n ${_robocop_arguments[$command]:-} && $line != *" --with "* ]]; then
    _robocop_launch_arguments "$word" "$command"
  elif [ "$command" = shell ]; then
    mapfile -t COMPREPLY < <(compgen -c -- "$word")
  fi
  # The others take paths: readline completes them where there is no reply.
}

complete -o default -F _robocop robocop
