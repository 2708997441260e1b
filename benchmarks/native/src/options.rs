//! Options of the command line.

/// The options of both benchmarks; both have defaults.
#[derive(Debug)]
pub struct Options {
    /// Numbers of shapes or discs.
    pub counts: Option<Vec<usize>>,
    /// Names of scenes.
    pub scenes: Option<Vec<String>>,
    /// Numbers of threads.
    pub threads: Vec<usize>,
    /// Beginnings of the names of libraries.
    pub rivals: Option<Vec<String>>,
    /// Timings of each library.
    pub rounds: usize,
    /// Sub-steps of a step; by default those of the scene.
    pub substeps: Option<usize>,
    /// Whether to write the results.
    pub keep: bool,
}

impl Options {
    /// Reads `--name value value …`.
    pub fn parse(arguments: impl Iterator<Item = String>) -> Self {
        let mut options = Self {
            counts: None,
            scenes: None,
            threads: vec![1, 2],
            rivals: None,
            rounds: 9,
            substeps: None,
            keep: true,
        };
        let mut groups: Vec<(String, Vec<String>)> = Vec::new();
        for word in arguments {
            match (word.strip_prefix("--"), groups.last_mut()) {
                (Some(name), _) => groups.push((name.to_owned(), Vec::new())),
                (None, Some((_, values))) => values.push(word),
                (None, None) => refuse(&word),
            }
        }
        for (name, values) in groups {
            match name.as_str() {
                "counts" => options.counts = Some(numbers(&values)),
                "scenes" => options.scenes = Some(values),
                "threads" => options.threads = numbers(&values),
                "rivals" => options.rivals = Some(values),
                "rounds" => options.rounds = *numbers(&values).first().unwrap_or(&9),
                "substeps" => options.substeps = numbers(&values).first().copied(),
                "keep" => options.keep = values != ["no"],
                _ => refuse(&name),
            }
        }
        options
    }

    /// Whether the scene `name` is selected.
    pub fn wants_scene(&self, name: &str) -> bool {
        self.scenes.as_ref().is_none_or(|scenes| scenes.iter().any(|scene| scene == name))
    }

    /// Whether the library `name` is selected.
    pub fn wants_rival(&self, name: &str) -> bool {
        self.rivals.as_ref().is_none_or(|all| all.iter().any(|start| name.starts_with(start)))
    }
}

fn numbers(values: &[String]) -> Vec<usize> {
    let number = |value: &String| value.replace('_', "").parse().ok();
    values.iter().map(|value| number(value).unwrap_or_else(|| refuse(value))).collect()
}

fn refuse(word: &str) -> ! {
    eprintln!("'{word}' means nothing here; see the top of benchmarks/native/src/main.rs");
    std::process::exit(2)
}
