# Fish completes thimble's commands, options and values by what `thimble complete` answers.
function __thimble_complete
    set -l words (commandline -opc) (commandline -ct)
    set -l text $words[1]
    for word in $words[2..]
        set text $text\n$word
    end
    for line in ($words[1] complete $text 2>/dev/null)
        if test "$line" = /files
            __fish_complete_path (commandline -ct)
        else
            echo $line
        end
    end
end
complete -c thimble -f -a '(__thimble_complete)'
