# shellcheck shell=bash disable=SC2154
# Bash completion of ./robocop. `./robocop completion` prints it after the values of:
#   _robocop_root       the checkout, whose worlds and models are listed at each completion
#   _robocop_options    the options of each command
#   _robocop_arguments  the launch arguments of those that have some

# World names that begin with $1, and files.
_robocop_worlds() {
  _robocop_names worlds .sdf "$1"
  mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -W random -- "$1")
  mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -f -- "$1")
  compopt -o filenames
}

# $1: a folder of the checkout, $2: an extension, $3: the word so far; the names of the files, without it.
_robocop_names() {
  local values; values=$(cd "$_robocop_root/$1" && printf '%s ' *"$2")
  mapfile -t COMPREPLY < <(compgen -W "${values//$2/}" -- "$3")
}

# Launch arguments with their values: $1 is the word so far, NAME or NAME:=VALUE; $2 the command.
_robocop_launch_arguments() {
  local start=${1%"${1##*[:=]}"} value=${1#*:=}
  case $1 in
    world:=*) _robocop_worlds "$value" ;;
    model:=*) _robocop_names config/models .yaml "$value" ;;
    *:=*)
      mapfile -t COMPREPLY < <(compgen -f -- "$value")
      compopt -o filenames
      ;;
    *)
      mapfile -t COMPREPLY < <(compgen -W "${_robocop_arguments[$2]}" -- "$1")
      COMPREPLY=("${COMPREPLY[@]#"$start"}")
      compopt -o nospace
      ;;
  esac
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
  elif [ "$command" = setup ]; then
    _robocop_names install/deb-packages .txt "$word"
  elif [ "$command" = help ]; then
    mapfile -t COMPREPLY < <(compgen -W "${!_robocop_options[*]}" -- "$word")
  elif [ "${COMP_WORDS[COMP_CWORD - 1]}" = --world ]; then
    _robocop_worlds "$word"
  fi
  # The others take paths: readline completes them where there is no reply.
}

complete -o default -F _robocop robocop
