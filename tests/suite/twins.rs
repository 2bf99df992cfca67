//! What is one step in the CPU reference and in the shaders has one name in both.

use std::path::{Path, PathBuf};

/// Files of src/cpu with the functions that have a twin in some shader; `=` where the twin's name is another, since the step has
/// a part there that the other has not.
const TWINS: &str = "
    bound: search=begin_search tested=note_other nearest=end_search crossed=note_crossed blocked=end_shadow
    bound: surface=note_surface lit=note_light shaded=note_lit background=note_background reflected=note_reflected
    bound: refracted=keep_cone resumed=go_on_with_cone width=bound_width reach=reach_of reach_aside is_edge near=near_of
    bound: push=add_root add_term=add_bound exit_error power_error has_sure_levels
    dd: fast_two_sum power_of_two two_product two_sum
    fill: color_of distance_squared index jump place smooth=filled
    intersect: accepted_root any_hit approach blocks exit_of is_behind nearer_of nearest_secondary nearest_seen roots
    margin: normal_error
    real: exp=exponential is_finite weakened
    refract: refraction_ray snell_at
    render: levels primary_ray resolve
    shade: local_color specular_power specular_term surface_at with_light
    trace: follow reflection_ray trace
    trace_refraction: tree_color
";

fn files(folder: &Path) -> Vec<PathBuf> {
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    paths.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

fn has(text: &str, function: &str) -> bool {
    let after = |(at, found): (usize, &str)| text[at + found.len()..].chars().next();
    text.match_indices(&format!("fn {function}")).map(after).any(|next| matches!(next, Some('(' | '<')))
}

#[test]
fn twins_have_one_name() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let shaders: String =
        files(&root.join("shaders")).into_iter().map(|path| std::fs::read_to_string(path).unwrap()).collect();
    for line in TWINS.lines().map(str::trim).filter(|line| !line.is_empty()) {
        let (file, functions) = line.split_once(": ").unwrap();
        let text = std::fs::read_to_string(root.join(format!("src/cpu/{file}.rs"))).unwrap();
        for function in functions.split(' ') {
            let (own, twin) = function.split_once('=').unwrap_or((function, function));
            assert!(has(&text, own), "src/cpu/{file}.rs has no {own}");
            assert!(has(&shaders, twin), "no shader has {twin}, the twin of {own} in src/cpu/{file}.rs");
        }
    }
}
