#!/bin/sh
# The recipes of tools/README.md for films drawn by several processes, as written: GNU parallel, with a process that is
# killed and drawn again, and what each task of a Slurm job array does. Both films are byte for byte that of one process.
# film.sh ROOT THIMBLE WORK_DIR; without GNU parallel the second half alone is run, and 77 returned.
set -eu
page=$(cd "$1" && pwd)/tools/README.md
program=$2
rm -rf "$3"
mkdir -p "$3/bin"
cd "$3"
# The command, but for small pictures, and dead the first time that it draws from frame 24 on.
cat >bin/thimble <<END
#!/bin/sh
[ "\$1" != render ] || set -- "\$@" --size 40x30 --quiet
case "\$*" in
  *'--part 24:12'*)
    if [ ! -e '$PWD/killed' ]; then
      touch '$PWD/killed'
      '$program' "\$@" &
      sleep 0.02
      kill -9 \$!
      wait \$!
    fi ;;
esac
exec '$program' "\$@"
END
chmod +x bin/thimble
export PATH="$PWD/bin:$PATH"
lines() {
  grep -E "^    .*$1" "$page" | sed 's/^    //'
}
fail() {
  echo "film: $1" >&2
  exit 1
}
join=$(lines 'thimble join film\..*\.gif' | head -n 1)
[ -n "$join" ] || fail "tools/README.md has no line that joins the film"
thimble render castle --turntable 48 -o whole.gif

task=$(lines 'SLURM_ARRAY_TASK_ID')
[ -n "$task" ] || fail "tools/README.md has no task of a job array"
for SLURM_ARRAY_TASK_ID in 3 1 0 2; do
  export SLURM_ARRAY_TASK_ID
  # A job that was killed is queued again.
  sh -c "$task" || sh -c "$task" || fail "this fails: $task"
done
sh -c "$join"
cmp film.gif whole.gif || fail "the tasks of a job array draw another film"
[ -e killed ] || fail "nothing was killed"
rm -f film.* killed

parallel --version 2>/dev/null | grep -q 'GNU parallel' || { echo "film: no GNU parallel; its recipe is skipped"; exit 77; }
draw=$(lines '\| parallel ')
[ -n "$draw" ] || fail "tools/README.md has no line for GNU parallel"
sh -c "$draw" 2>log || { cat log; fail "this fails: $draw"; }
[ -e killed ] || fail "nothing was killed"
sh -c "$join"
cmp film.gif whole.gif || fail "GNU parallel's processes draw another film"
