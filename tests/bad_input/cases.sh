# The cases of run.sh. `edit NAME BASE FROM BAD MENDED PLACE REMEDY`: in the sound scene BASE the text FROM becomes BAD, which
# must be refused with a message that holds PLACE and REMEDY; with MENDED in the same place the scene must be accepted.
# An empty MENDED stands for FROM itself.

# --- texts that are no scenes
text empty_file "" "empty" "a scene is a YAML map"
text only_a_comment "# nothing here" "empty" "a scene is a YAML map"
text plain_prose "Pour the powder onto the plate." "a scene is a map" "write blocks"
text a_list "[1, 2, 3]" "a scene is a map" "write blocks"
text two_documents $'duration: 1\n---\nduration: 2' "second YAML document" "one scene per file"
text unclosed_bracket $'materials: {a: {density: 1000}\nduration: 1' "not valid YAML" "brackets"
text tabs $'materials:\n\ta: {density: 1000}\nduration: 1' "not valid YAML" "no tabs"
text endless_nesting "$(printf '[%.0s' {1..20000})" "" "bracket"
text nothing_moves $'materials: {a: {density: 1000}}\nduration: 1' "nothing to simulate" "add a body"
text alias_of_itself 'a: &x [*x]' "levels deep" "brackets"
edit duplicate_key heap.yaml "    count: 40" $'    count: 40\n    count: 50' "" "given twice" "keep one"
edit truncated heap.yaml $'gravity: [0, 0, -9.81]\nsolver: {time_step: 5.0e-5, tolerance: 1.0e-3, max_iterations: 500}\nduration: 0.005' \
  "gravity: [0, 0" "" "not valid YAML" "brackets"
edit cut_off_after_tools heap.yaml $'duration: 0.005\nframe_interval: 1 ms' "" "duration: 0.005" '`duration` is missing' "add"

# --- keys
edit unknown_key heap.yaml "    size:" "    siez:" "" "grains.powder.siez" 'did you mean `size`?'
edit unknown_block heap.yaml "solver:" "slover:" "" "slover: unknown key" 'did you mean `solver`?'
edit missing_key heap.yaml "    outlet_diameter: 0.6 mm"$'\n' "" "" '`outlet_diameter` is missing' "add"
edit two_problems heap.yaml "{density: 1020 kg/m3}" "{density: -1020 kg/m2, colour: white}" "" "materials.pa12.colour" "keys here"
edit unknown_tool_type heap.yaml "  base:" "  bass:" "" "tools.bass" 'did you mean `base`?'
edit unknown_shape bodies.yaml "type: box" "type: bx" "" "shapes.block.type" 'did you mean `box`?'
edit unknown_grain_shape heap.yaml "{sphere: 1, twin: 1}" "{sphere: 1, twins: 1}" "" "mix.twins" 'did you mean `twin`?'
edit unknown_material heap.yaml "material: pa12" "material: pa21" "" "grains.powder.material" 'did you mean `pa12`?'
edit unknown_effect bodies.yaml "quadratic_drag" "quadratic_darg" "" "effects" 'did you mean `quadratic_drag`?'
edit effect_of_the_recording bodies.yaml "{quadratic_drag:" "{length_scale: {factor: 1.1}, quadratic_drag:" "" \
  "not available" "remove it"
edit magnus_without_a_fluid bodies.yaml "{quadratic_drag:" "{magnus: {lift: 1}, quadratic_drag:" \
  "{magnus: {lift: 1, fluid_density: 1.2}, quadratic_drag:" "effects.magnus" "fluid_density"
edit shake_of_negative_frequency bodies.yaml "{quadratic_drag:" \
  "{periodic_force: {amplitude: [0, 0, 1], frequency: -5}, quadratic_drag:" \
  "{periodic_force: {amplitude: [0, 0, 1], frequency: 5 Hz, phase: 90 deg}, quadratic_drag:" "periodic_force.frequency" "zero or positive"
edit friction_without_a_reference bodies.yaml "{quadratic_drag:" "{rate_dependent_friction: {slope: 0.01}, quadratic_drag:" \
  "{rate_dependent_friction: {slope: 0.01, reference_speed: 1 mm/s}, quadratic_drag:" "rate_dependent_friction" "reference_speed"
edit friction_ratio_of_zero bodies.yaml "{quadratic_drag:" "{anisotropic_friction: {ratio: 0, direction_deg: 30}, quadratic_drag:" \
  "{anisotropic_friction: {ratio: 0.5, direction_deg: 30}, quadratic_drag:" "anisotropic_friction.ratio" "positive"
edit restitution_of_no_speed bodies.yaml "{quadratic_drag:" "{rate_dependent_restitution: {exponent: 0.25, reference_speed: 0}, quadratic_drag:" \
  "{rate_dependent_restitution: {exponent: 0.25, reference_speed: 1}, quadratic_drag:" "rate_dependent_restitution.reference_speed" "positive"
edit bridge_that_never_ruptures bodies.yaml "{quadratic_drag:" "{liquid_bridge: {force: 1, rupture: 0}, quadratic_drag:" \
  "{liquid_bridge: {force: 1, rupture: 1 mm}, quadratic_drag:" "liquid_bridge.rupture" "positive"
edit compliance_in_pascal bodies.yaml "{quadratic_drag:" "{contact_compliance: {stiffness: 1 MPa}, quadratic_drag:" \
  "{contact_compliance: {stiffness: 1 MN/m, damping: 3 N s/m}, quadratic_drag:" "contact_compliance.stiffness" "N/m"
edit misspelt_contact_effect bodies.yaml "{quadratic_drag:" "{liquid_brigde: {force: 1}, quadratic_drag:" "" \
  "effects" 'did you mean `liquid_bridge`?'
edit vibration_of_nothing bodies.yaml "effects: {quadratic_drag: {coefficient: 0.47, fluid_density: 1.2}}" \
  "effects: {moving_wall_speed: {factor: 2}}" "effects: {base_vibration: {amplitude: 1 um, frequency: 50 Hz}}" \
  "effects.moving_wall_speed" "motion"
edit inertia_of_two_factors bodies.yaml "{quadratic_drag:" "{inertia: {factor: [1, 2]}, quadratic_drag:" \
  "{inertia: {factor: 1.2}, quadratic_drag:" "inertia.factor" "[x, y, z]"
edit offset_as_a_number bodies.yaml "{quadratic_drag:" "{center_of_mass_offset: {offset: 0.01}, quadratic_drag:" \
  "{center_of_mass_offset: {offset: [0, 0, 1 mm]}, quadratic_drag:" "center_of_mass_offset.offset" "[x, y, z]"
edit softening_of_nothing bodies.yaml "{quadratic_drag:" "{thermal_softening: {temperature: 350, scale: 20}, quadratic_drag:" \
  "{wall_friction: {friction: 0.3}, quadratic_drag:" "effects.thermal_softening" "cohesion"
edit sizes_below_zero heap.yaml "gravity:" $'effects: {size_distribution: {sd_factor: 2.5}}\ngravity:' \
  $'effects: {size_distribution: {mean_factor: 1.1, sd_factor: 0.5}, grain_shape: {aspect: 1.1}}\ngravity:' "effects.size_distribution" "smaller"
edit shape_apart heap.yaml "gravity:" $'effects: {grain_shape: {aspect: 9}}\ngravity:' \
  $'effects: {grain_shape: {aspect: 0.9}}\ngravity:' "effects.grain_shape" "twin"
edit effect_that_is_a_pair_law bodies.yaml "{quadratic_drag:" "{restitution: 0.5, quadratic_drag:" "" "effects.restitution" "pairs"
edit pair_in_wrong_order heap.yaml "pa12-steel:" "steel-pa12:" "" "pairs.steel-pa12" 'write `pa12-steel`'
edit pair_of_nobody heap.yaml "pa12-steel:" "pa12-brass:" "" "pairs.pa12-brass" "known:"
edit missing_pair heap.yaml "  pa12-steel: {friction: 0.5}"$'\n' "" "" "pa12-steel" "add"
edit name_with_blanks heap.yaml "  powder:" "  my powder:" "  my_powder:" "grains.my powder" "letters"
edit name_used_twice bodies.yaml "effects:" $'tools: {block: {type: floor, material: steel, position: [0, 0, -1]}}\neffects:' \
  $'tools: {ground: {type: floor, material: steel, position: [0, 0, -1]}}\neffects:' "tools.block" "rename"

# --- types and quantities
edit text_for_a_number heap.yaml "count: 40" "count: many" "" "grains.powder.count" "plain number"
edit map_for_a_number heap.yaml "duration: 0.005" "duration: {value: 0.005}" "" "duration: is a map" "write one value"
edit number_for_a_map heap.yaml "{sphere: 1, twin: 1}" "3" "" "grains.powder.mix" "keys here"
edit empty_value heap.yaml "    diameter: 2 mm" "    diameter:" "" "tools.base.diameter" "write one value"
edit vector_too_short bodies.yaml "[0, 0, 0.06]" "[0, 0.06]" "" "bodies.block.position" "[x, y, z]"
edit not_a_number heap.yaml "time_step: 5.0e-5" "time_step: .nan" "" "solver.time_step" "finite"
edit infinite bodies.yaml "velocity: [1, 0, 0]" "velocity: [.inf, 0, 0]" "" "bodies.block.velocity" "finite"
edit beyond_all_numbers heap.yaml "duration: 0.005" "duration: 1e999" "" "duration" "range of numbers"
edit decimal_comma heap.yaml "rolling_friction: 0.05" "rolling_friction: '0,05'" "" "rolling_friction" "decimal point"
edit wrong_dimension heap.yaml "outlet_diameter: 0.6 mm" "outlet_diameter: 0.6 mg" "" "outlet_diameter" "expected m"
edit unknown_unit heap.yaml "1020 kg/m3" "1020 kgg/m3" "" "materials.pa12.density" 'did you mean `kg`?'
edit rpm_for_a_frequency heap.yaml "  base:" $'  base:\n    motion: {vibration_amplitude: [0, 0, 1 um], vibration_frequency: 50 rpm}' \
  $'  base:\n    motion: {vibration_amplitude: [0, 0, 1 um], vibration_frequency: 50 Hz}' "vibration_frequency" "Hz"
edit half_a_grain heap.yaml "count: 40" "count: 40.5" "" "grains.powder.count" "whole number"
edit no_grains heap.yaml "count: 40" "count: 0" "" "grains.powder.count" "positive"
edit negative_size heap.yaml "normal: [58 um, 15 um]" "normal: [-58 um, 15 um]" "" "grains.powder.size.normal" "zero or positive"
edit negative_radius bodies.yaml "{type: sphere, radius: 0.1}," "{type: sphere, radius: -0.1}," "" "radius" "positive"
edit zero_density heap.yaml "7800 kg/m3" "0" "" "materials.steel.density" "positive"
edit zero_mass bodies.yaml "mass: 2" "mass: 0" "" "bodies.dimer.mass" "positive"
edit impossible_inertia bodies.yaml "[0.01, 0.02, 0.02]" "[0.01, 0.02, 0.2]" "" "bodies.dimer.inertia" "principal moments"
edit restitution_above_one heap.yaml "restitution: 0.2" "restitution: 1.2" "" "restitution" "at most 1"
edit negative_friction heap.yaml "{friction: 0.5, roll" "{friction: -0.5, roll" "" "pairs.pa12-pa12.friction" "zero or positive"
edit quaternion_of_no_length bodies.yaml "[1, 0, 0, 0]" "[0, 0, 0, 0]" "" "bodies.block.orientation" "[1, 0, 0, 0]"
edit not_a_truth_value bodies.yaml "fixed: true" "fixed: perhaps" "" "bodies.floor.fixed" '`true` or `false`'
edit unknown_solver heap.yaml "max_iterations: 500" "method: newton" "method: apgd" "solver.method" "gauss_seidel"

# --- shapes and bodies
edit infinite_body_set_free bodies.yaml ", fixed: true" "" "" "bodies.floor" "fixed: true"
edit missing_mesh bodies.yaml "wedge.obj" "wegde.obj" "" "shapes.wedge.file" "OBJ"
edit mesh_that_is_no_mesh bodies.yaml "wedge.obj" "bodies.yaml" "" "shapes.wedge.file" "OBJ"
edit broken_mesh bodies.yaml "wedge.obj" "broken.obj" "" "broken.obj:5" "vertices"
edit compound_of_nothing bodies.yaml "parts: [{type: sphere, radius: 0.1}, {type: sphere, radius: 0.1, position: [0.1, 0, 0]}]" \
  "parts: []" "" "shapes.dimer.parts" "at least one part"
edit count_and_mass heap.yaml "count: 40" $'count: 40\n    mass: 5 ug' "mass: 5 ug" "grains.powder" "exactly one"
edit range_upside_down heap.yaml "[30 um, 100 um]" "[100 um, 30 um]" "" "grains.powder.size.range" "[smallest, largest]"
edit range_beside_the_law heap.yaml "[30 um, 100 um]" "[30 mm, 100 mm]" "" "grains.powder.size.range" "missing unit"
edit no_room heap.yaml "frustum: {base: [0, 0, 1 mm], radius_bottom: 0.3 mm, radius_top: 0.6 mm, height: 0.5196 mm}" \
  "cylinder: {base: [0, 0, 1.2 mm], radius: 0.1 mm, height: 0.15 mm}, grow: false" \
  "cylinder: {base: [0, 0, 1.2 mm], radius: 0.1 mm, height: 0.15 mm}, grow: true" "powder" "grow"

# --- absurd, though well formed
edit density_without_unit heap.yaml "1020 kg/m3" "1.02" "1.02 g/cm3" "materials.pa12.density" "did you mean 1.02 g/cm3?"
edit grain_of_45_m heap.yaml "{normal: [58 um, 15 um], range: [30 um, 100 um]}" "45" "45 um" "grains.powder.size" "did you mean 45 um?"
edit step_of_10_s heap.yaml "time_step: 5.0e-5" "time_step: 10" "" "solver.time_step" "did you mean"
edit step_too_coarse heap.yaml $'solver: {time_step: 5.0e-5, tolerance: 1.0e-3, max_iterations: 500}\nduration: 0.005' \
  $'solver: {time_step: 0.05}\nduration: 1' $'solver: {time_step: 5.0e-5}\nduration: 1' "solver.time_step" "or below"
edit billion_grains heap.yaml "count: 40" "count: 1000000000" "" "1e+09 grains" "smaller apparatus"
edit funnel_narrower_than_a_grain heap.yaml "outlet_diameter: 0.6 mm" "outlet_diameter: 60 um" "" "tools.funnel.outlet_diameter" "make it at least"
edit base_narrower_than_a_grain heap.yaml "diameter: 2 mm" "diameter: 20 um" "" "tools.base.diameter" "make it at least"
edit overlapping_tools heap.yaml $'    material: steel\n    position: [0, 0, 1 mm]' $'    material: steel\n    position: [0, 0, 0.05 mm]' "" "cut into each other" "move one"
edit funnel_under_the_base heap.yaml $'    material: steel\n    diameter' $'    material: steel\n    position: [0, 0, 5 mm]\n    diameter' "" "below the plate" "raise it"
edit fill_outside_the_funnel heap.yaml "radius_bottom: 0.3 mm" "radius_bottom: 0.5 mm" "" "grains.powder.fill" "narrower"
edit fill_narrower_than_a_grain heap.yaml "frustum: {base: [0, 0, 1 mm], radius_bottom: 0.3 mm, radius_top: 0.6 mm, height: 0.5196 mm}" \
  "cylinder: {base: [0, 0, 1.2 mm], radius: 20 um, height: 0.3 mm}" "cylinder: {base: [0, 0, 1.2 mm], radius: 0.2 mm, height: 0.3 mm}" \
  "grains.powder.fill" "check the unit"
edit fill_without_height heap.yaml "height: 0.5196 mm" "height: 1e-300" "" "grains.powder.fill" "check the unit"
edit denormal_number heap.yaml "height: 0.5196 mm" "height: 1e-320" "" "fill.frustum.height" "a number in m"
edit grains_inside_a_wall heap.yaml "  base:" $'  block: {type: plate, material: steel, size: [0.3 mm, 0.3 mm, 0.3 mm], position: [0, 0, 1.5 mm]}\n  base:' \
  $'  block: {type: plate, material: steel, size: [0.3 mm, 0.3 mm, 0.3 mm], position: [0, 0, 4 mm]}\n  base:' "grains.powder.fill" "free space"
edit funnel_that_never_opens heap.yaml "opens: 0.002" "opens: 2" "" "tools.funnel.opens" "open it earlier"
edit funnel_upside_down heap.yaml "top_diameter: 1.2 mm" "top_diameter: 0.2 mm" "" "tools.funnel.top_diameter" "wider"
edit cohesion_of_a_newton heap.yaml "restitution: 0.2}" "cohesion: 1, cohesion_range: 0.3 um}" "cohesion: 1 nN, cohesion_range: 0.3 um}" \
  "pairs.pa12-pa12.cohesion" "did you mean 1 nN?"
edit friction_in_percent heap.yaml "{friction: 0.5, roll" "{friction: 50, roll" "" "pairs.pa12-pa12.friction" "did you mean 0.5"
edit gravity_in_millimetres heap.yaml "-9.81" "-9810" "" "gravity" "did you mean"
edit faster_than_sound bodies.yaml "velocity: [1, 0, 0]" "velocity: [10000, 0, 0]" "" "bodies.block.velocity" "mm/s"
edit feather_of_lead bodies.yaml "mass: 2, inertia: [0.01, 0.02, 0.02]" "mass: 2e6" "mass: 2" "bodies.dimer.mass" "units"

# --- periodic cells
per=$'duration: 0.02\nperiodic: '
edit periodic_along_z bodies.yaml "duration: 0.02" "${per}{z: [-1, 1]}" "${per}{y: [-1, 1]}" "periodic.z" "only x and y"
edit periodic_upside_down bodies.yaml "duration: 0.02" "${per}{y: [1, -1]}" "${per}{y: [-1, 1]}" "periodic.y" "[lower, upper]"
edit periodic_without_width bodies.yaml "duration: 0.02" "${per}{y: [1, 1]}" "${per}{y: [0, 1]}" "periodic.y" "[lower, upper]"
edit periodic_along_nothing bodies.yaml "duration: 0.02" "${per}{}" "${per}{x: [-2, 2], y: [-1, 1]}" "names no axis" "periodic: {y:"
edit periodic_of_a_mass bodies.yaml "duration: 0.02" "${per}{y: [0, 1 kg]}" "${per}{y: [0, 100 cm]}" "periodic.y" "expected m"
edit periodic_of_one_number bodies.yaml "duration: 0.02" "${per}{y: 1}" "${per}{y: [0, 1]}" "periodic.y" "list"
edit periodic_too_narrow bodies.yaml "duration: 0.02" "${per}{y: [-0.1, 0.1]}" "${per}{y: [-0.6, 0.6]}" "periodic.y" "or longer"
edit periodic_step_at_the_seam bodies.yaml "duration: 0.02" "${per}{y: [-1, 1]}
tools: {slope: {type: floor, material: steel, normal: [0, 0.1, 1], position: [0, 0, -3]}}" "${per}{y: [-1, 1]}
tools: {slope: {type: floor, material: steel, normal: [0.1, 0, 1], position: [0, 0, -3]}}" "tools.slope" "make it a floor"
edit periodic_plate_that_ends bodies.yaml "duration: 0.02" "${per}{y: [-1, 1]}
tools: {plate: {material: steel, size: [1, 2, 0.1], position: [0, 0, -1]}}" "${per}{y: [-1, 1]}
tools: {plate: {material: steel, size: [1, 3, 0.1], position: [0, 0, -1]}}" "tools.plate" "m long if centred"
edit periodic_roller_that_leaves bodies.yaml "duration: 0.02" "${per}{y: [-1, 1]}
tools: {roller: {material: steel, diameter: 0.2, width: 3, position: [3, 0, 1], motion: {velocity: [0, 0.1, 0]}}}" "${per}{y: [-1, 1]}
tools: {roller: {material: steel, diameter: 0.2, width: 3, position: [3, 0, 1], motion: {velocity: [0.1, 0, 0]}}}" "tools.roller" "without motion along y"
edit periodic_post_outside bodies.yaml "duration: 0.02" "${per}{y: [-1, 1]}
tools: {plate: {material: steel, size: [0.1, 0.1, 0.1], position: [0, 1.5, 2]}}" "${per}{y: [-1, 1]}
tools: {plate: {material: steel, size: [0.1, 0.1, 0.1], position: [0, 0.9, 2]}}" "tools.plate" "move it to between"
edit periodic_fill_outside heap.yaml "duration: 0.005" $'duration: 0.005\nperiodic: {y: [-0.5 mm, 5 mm]}' $'duration: 0.005\nperiodic: {y: [-2.5 mm, 5 mm]}' \
  "grains.powder" "keep it within the cell"

# --- layers
edit squares_in_nanometres bed.yaml "square: 60 um" "square: 6 nm" "" "layer.surface.square" "one grain diameter"
edit settle_step_longer_than_the_settling bed.yaml "settle_time_step: 1.0e-4" "settle_time_step: 0.2" "" "layer.settle_time_step" "did you mean"
edit spreader_that_arrives_before_it_starts bed.yaml "to: 0.6 mm" "to: -0.2 mm" "" "layer.to" 'make `to` larger'
