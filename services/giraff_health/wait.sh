# sh wait.sh SERVICE...: exit 0 while these services are well, 1 as soon as one is not, with what is wrong.
#
# Docker's check, in each container. To start a program in a container costs Docker many times what the program does. So
# this one stays for a minute and looks every 2 s, and what is wrong shows at once. Only where the last check found
# something wrong, and at the start, it looks once: Docker waits for the end of a check.
#
# It reads the file of faults that each service's loop keeps and touches beside its socket (docs/health.md).

[ $# -gt 0 ] || {
    echo "usage: sh wait.sh SERVICE..."
    exit 2
}
asked=$RUNTIME_DIRECTORY/asked
now=$asked.$$ # of this check alone
looks=1
# Not the same in each container, so that checks that began together do not end together.
[ -e "$asked" ] && looks=$((28 + $$ % 8))

while [ $looks -gt 0 ]; do
    looks=$((looks - 1))
    : >"$asked"
    : >"$now"
    sleep 2
    is_wrong=
    for service; do
        faults=$RUNTIME_DIRECTORY/$service.faults
        if [ ! -e "$faults" ]; then
            wrong="$service has not said how it is; see its log"
        elif [ -s "$faults" ]; then
            wrong=$(cat "$faults")
        elif [ "$faults" -ot "$now" ]; then
            wrong="$service: its loop has not turned for 2 s: it hangs, or this machine is overloaded"
        else
            continue
        fi
        is_wrong=yes
        printf '%s\n' "$wrong"
    done
    rm -f "$now"
    [ -z "$is_wrong" ] || {
        rm -f "$asked"
        exit 1
    }
done
