"""The word of `giraff completion`, and the scripts by which a shell asks `giraff` what a word can become.

`_GIRAFF_COMPLETE=1 giraff WORDS` answers for the last word: a line for each candidate, with a tab and its help behind.
A line of a tab and `file` asks the shell for its own files. No candidate is ever run or expanded by a shell.
"""

from typing import Annotated, Final, Literal

import typer

_BASH: Final = r"""# bash completion of giraff; bash 4.4 or newer
_giraff() {
    local line value
    COMPREPLY=()
    while IFS= read -r line; do
        if [[ $line == $'\tfile' ]]; then
            compopt -o default
            continue
        fi
        value=${line%%$'\t'*}
        if [[ $value == *. ]]; then
            compopt -o nospace
        fi
        printf -v value %q "$value"
        COMPREPLY+=("$value")
    done < <(_GIRAFF_COMPLETE=1 "$1" "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null </dev/null)
}
complete -o nosort -F _giraff giraff
"""
_ZSH: Final = r"""#compdef giraff
_giraff() {
    local line value
    local -a whole open
    for line in "${(@f)$(_GIRAFF_COMPLETE=1 ${(Q)words[1]} "${(@Q)words[2,CURRENT]}" 2>/dev/null </dev/null)}"; do
        value=${line%%$'\t'*}
        if [[ $line == $'\tfile' ]]; then
            _files
        elif [[ $value == *. ]]; then
            open+=("${value//:/\\:}:${line#*$'\t'}")
        elif [[ -n $value ]]; then
            whole+=("${value//:/\\:}:${line#*$'\t'}")
        fi
    done
    _describe giraff whole -- open -S ''
}
if [[ $funcstack[1] == _giraff ]]; then
    _giraff "$@"
else
    (( $+functions[compdef] )) || { autoload -U compinit && compinit -i }
    compdef _giraff giraff
fi
"""
_FISH: Final = r"""# fish completion of giraff
function __giraff_complete
    set -l words (commandline -opc)
    set -l current (commandline -ct)
    for line in (env _GIRAFF_COMPLETE=1 $words "$current" 2>/dev/null </dev/null)
        if test "$line" = \tfile
            __fish_complete_path "$current"
        else
            printf '%s\n' "$line"
        end
    end
end
complete -c giraff -f -a '(__giraff_complete)'
"""
_SCRIPTS: Final = {"bash": _BASH, "zsh": _ZSH, "fish": _FISH}
"""By the name of the shell."""


def completion(shell: Annotated[Literal["bash", "zsh", "fish"], typer.Argument(metavar="SHELL")]) -> None:
    """Print the script by which bash, zsh or fish completes `giraff` at the TAB key. See docs/tools.md.

    It completes verbs, options and files, and from the network robots, topics, services and parameters.
    """
    typer.echo(_SCRIPTS[shell], nl=False)
