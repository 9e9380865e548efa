# Bad arguments, files and folders, for run.sh.

# --- files and arguments of repose-check
if wanted files; then
  mkdir folder
  refuses no_such_file "absent.yaml" "check the name" "$bin/repose-check" absent.yaml
  refuses directory_for_a_file "is a directory" "name the scene file" "$bin/repose-check" folder
  head -c 2000 /dev/zero >zeros.yaml
  refuses binary_file "not a text file" "YAML text" "$bin/repose-check" zeros.yaml
  accepts a_scene_file "$bin/repose-check" bodies.yaml
fi
if wanted samples; then
  for scene in "$here"/../../scenarios/configs/*.yaml; do
    [[ $scene == */grain_shapes.yaml || $scene == */study_* ]] || accepts "${scene##*/}" "$bin/repose-check" "$scene"
  done
fi
if wanted arguments; then
  refuses no_argument "SCENE.yaml" "--help" "$bin/repose-check"
  refuses unknown_option "--qiet" "--help" "$bin/repose-check" bodies.yaml --qiet
  refuses seed_that_is_no_number "--seed" "--help" "$bin/repose-check" bodies.yaml --seed eleven
  refuses no_threads "--threads" "--help" "$bin/repose-check" bodies.yaml --threads 0
  refuses unknown_backend "bulet" "known backends" "$bin/repose-check" bodies.yaml --backend bulet
  refuses set_without_value "duration" "key.path=value" "$bin/repose-check" bodies.yaml --set duration
  refuses set_of_unknown_name "--set bodies.blok.mass" 'did you mean `block`?' "$bin/repose-check" bodies.yaml --set bodies.blok.mass=2
  refuses set_of_unknown_key "--set bodies.block.mas" 'did you mean `mass`?' "$bin/repose-check" bodies.yaml --set bodies.block.mas=2
  refuses set_of_wrong_type "--set duration" "a number in s" "$bin/repose-check" bodies.yaml --set duration=soon
  accepts sound_arguments "$bin/repose-check" bodies.yaml --seed 11 --threads 1 --backend dvi --set bodies.block.mass=2
fi

# --- runs: folders and checkpoints
if [[ -x $bin/repose-run ]] && wanted runs; then
  run=("$bin/repose-run" heap.yaml --quiet --threads 1)
  refuses run_of_a_bad_scene "materials.pa12.density" "did you mean 2.5 g/cm3?" "${run[@]}" --out bad --set materials.pa12.density=2.5
  refuses run_of_a_billion_grains "1e+09 grains" "smaller apparatus" "${run[@]}" --out bad --set grains.powder.count=1000000000

  slip='effects.rate_dependent_friction={slope: 0.02, reference_speed: 0.1}'
  refuses physics_that_the_backend_lacks "cannot do: rate_dependent_friction" "--allow-unsupported" "${run[@]}" --out bad --backend bullet --set "$slip"
  accepts physics_left_out_when_asked "${run[@]}" --out lacking --backend bullet --set "$slip" --allow-unsupported
  accepts physics_left_out_is_listed sh -c 'tr -d " \n" <lacking/result.json | grep -qF "\"unsupported\":[\"rate_dependent_friction\"]"'

  echo "in the way" >file
  refuses output_below_a_file "file" "--out" "${run[@]}" --out file/run
  mkdir locked && chmod a-w locked
  # The superuser may write anywhere but here.
  if [[ $(id -u) -eq 0 ]]; then locked=/proc/repose; else locked=locked/run; fi
  refuses read_only_output "$locked" "--out" "${run[@]}" --out "$locked"
  accepts writable_output "${run[@]}" --out sound --checkpoint-interval 0

  checkpoints=(sound/checkpoints/*.h5)
  for damage in truncated emptied overwritten; do
    cp -r sound "$damage"
    rm -f "$damage/result.json" "$damage/run.h5"
    for checkpoint in "${checkpoints[@]}"; do
      copy=$damage/checkpoints/${checkpoint##*/}
      case $damage in
        truncated) truncate -s $(($(stat -c %s "$copy") / 2)) "$copy" ;;
        emptied) : >"$copy" ;;
        overwritten) head -c 5000 /dev/zero | tr '\0' 'x' >"$copy" ;;
      esac
    done
    refuses "resume_from_${damage}_checkpoints" "checkpoint" "resume" "${run[@]}" --out "$damage" --resume
  done
  refuses resume_of_another_scene "sound" "scene" "${run[@]}" --out sound --resume --set duration=0.004
  refuses resume_of_another_seed "sound" "seed" "${run[@]}" --out sound --resume --seed 7
  accepts resume_of_the_same_run "${run[@]}" --out sound --resume
fi
