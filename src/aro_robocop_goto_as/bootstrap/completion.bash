# shellcheck shell=bash disable=SC2154
# Bash completion of ./robocop. `./robocop completion` prints it after the values of:
#   _robocop_root     the checkout, whose launch files and worlds are read at each completion
#   _robocop_options  the options of each command

# Launch arguments with their values: $1 is the word so far, NAME or NAME:=VALUE; $2 the launch file.
_robocop_launch_arguments() {
  local names values="" start=${1%"${1##*[:=]}"}
  if [[ $1 != *:=* ]]; then
    names=$(sed -n 's/^ *<arg name="\([a-z_]*\)".* default=.*/\1:=/p' "$_robocop_root/launch/$2")
    mapfile -t COMPREPLY < <(compgen -W "$names" -- "$1")
    COMPREPLY=("${COMPREPLY[@]#"$start"}")
    compopt -o nospace
    return
  fi
  case ${1%%:=*} in
    world) values="random $(cd "$_robocop_root/worlds" && printf '%s ' *.sdf)" ;;
    model) values=$(cd "$_robocop_root/config/models" && printf '%s ' *.yaml) ;;
  esac
  values=${values//.sdf/} values=${values//.yaml/}
  mapfile -t COMPREPLY < <(compgen -W "$values" -- "${1#*:=}"; compgen -f -- "${1#*:=}")
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
  elif [ "$command" = run ]; then
    _robocop_launch_arguments "$word" robocop_goto_as.launch
  elif [[ $command = sim && $line != *" --with "* ]]; then
    _robocop_launch_arguments "$word" robocop_sim.launch
  elif [ "$command" = shell ]; then
    mapfile -t COMPREPLY < <(compgen -c -- "$word")
  fi
  # The others take paths: readline completes them where there is no reply.
}

complete -o default -F _robocop robocop
