//! Settings: usual ones, a user's, and what is wrong with those.

use super::*;

#[test]
fn what_is_settled_stands_over_what_was_chosen() {
    for (text, chosen, expect) in [
        ("", "", ("dark", true)),
        ("", "theme = \"light\"\nmouse = false", ("light", false)),
        ("theme = \"contrast\"", "theme = \"light\"\nmouse = false", ("contrast", false)),
        ("mouse = true", "mouse = false", ("dark", true)),
        ("theme = \"mine\"\n[themes.mine]\nlike = \"light\"\nerror = \"bold #aa0000\"", "", ("mine", true)),
        ("", "no toml at all", ("dark", true)),
        ("", "theme = \"gone\"", ("dark", true)),
    ] {
        let config = Config::of(text, chosen);
        assert_eq!((config.themes[config.theme].name.as_str(), config.mouse), expect, "{text} {chosen}");
        assert_eq!(config.wrong, Vec::<String>::new(), "{text}");
    }
}

#[test]
fn what_is_wrong_is_said_and_the_rest_holds() {
    for (text, expect) in [
        ("theme = \"noon\"", "there is no theme noon; there are dark, light, contrast"),
        ("colour = 3", "colour is not known; there are keys, theme, themes, mouse, plugins"),
        ("[themes.mine]\nhat = \"blue\"", "themes.mine: hat is no role; there are accent, "),
        ("[themes.mine]\ndim = \"muddy\"", "themes.mine.dim: a colour is wanted"),
        ("[keys]\nundoo = \"u\"", "there is no action undoo"),
        ("keys = ", "it is no TOML: "),
    ] {
        let config = Config::of(text, "");
        assert!(config.wrong[0].starts_with(expect), "{text}: {:?}", config.wrong);
        assert!(config.complaint().is_some_and(|line| line.starts_with("config.toml: ")));
    }
}

#[test]
fn the_settings_of_the_guide_are_understood() {
    let guide = include_str!("../../../../docs/settings.md");
    let example = guide.split("```").nth(1).and_then(|block| block.strip_prefix("toml"));
    let config = Config::of(example.unwrap_or("theme = \"the guide has no example\""), "");
    assert_eq!(config.wrong, Vec::<String>::new());
    assert_eq!(config.themes[config.theme].name, "mine");
}
