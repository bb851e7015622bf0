//! What is refused, and in which words.

use super::models::{folder, pendulum, read};
use physics::robot::Description;

#[test]
fn refusals_name_the_element_and_what_to_do() {
    let second = "<body name=\"next\"><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/><joint name=\"other\"/></body>";
    let with = |after: &str| pendulum("", second, after);
    for (text, expected) in [
        (
            with("<equality><joint name=\"tie\" joint1=\"hinge\"/></equality>"),
            "equality constraint \"tie\" acts on joint \"hinge\"",
        ),
        (
            with("<equality><weld body1=\"next\"/></equality>"),
            "ties body \"next\" to body \"world\"",
        ),
        (
            with(
                "<tendon><fixed name=\"cord\"><joint joint=\"hinge\" coef=\"1\"/></fixed></tendon>",
            ),
            "tendon \"cord\" acts on joint \"hinge\"",
        ),
        (
            pendulum("", "<composite type=\"cable\"/>", ""),
            "body \"link\" holds <composite>",
        ),
        (
            pendulum(
                "",
                "<body name=\"tool\"><geom name=\"drill\" type=\"mesh\" mesh=\"drill\"/></body>",
                "",
            ),
            "geom \"drill\" of body \"tool\" is a mesh",
        ),
        (
            pendulum("", "<joint name=\"second\" axis=\"1 0 0\"/>", ""),
            "move the same body \"link\"",
        ),
        (
            pendulum("<compiler settotalmass=\"3\"/>", "", ""),
            "settotalmass",
        ),
        (
            pendulum("<compiler coordinate=\"global\"/>", "", ""),
            "only local coordinates",
        ),
        (
            pendulum("", "<geom class=\"nowhere\" size=\"1\"/>", ""),
            "class \"nowhere\"",
        ),
        (
            pendulum("", "<body euler=\"1 2\"/>", ""),
            "it needs 3 numbers",
        ),
        (
            pendulum("", "<body quat=\"nan 0 0 0\"/>", ""),
            "finite numbers are needed",
        ),
        (
            pendulum("", "<body name=\"link\"/>", ""),
            "two bodies are called \"link\"",
        ),
        (
            "<mujoco><include file=\"arm.xml\"/></mujoco>".to_owned(),
            "includes \"arm.xml\"",
        ),
        (
            "<mujocoinclude/>".to_owned(),
            "outermost element is <mujocoinclude>",
        ),
        (
            "<mujoco><worldbody/></mujoco>".to_owned(),
            "no moving joint",
        ),
        ("<mujoco>".to_owned(), "cannot be parsed"),
        (
            "<mujoco><worldbody><body><joint name=\"j\"/></body></worldbody></mujoco>".to_owned(),
            "has no mass",
        ),
    ] {
        let error = read(&text).map(|_| ()).expect_err(&text).to_string();
        assert!(error.contains(expected), "{error}");
        assert!(!error.contains('\n'), "{error}");
    }
}

#[test]
fn choices_that_make_no_chain_are_refused() {
    let choose = |file: &str, joints: &str| -> String {
        let joints: Vec<String> = joints
            .split(',')
            .filter(|j| !j.is_empty())
            .map(str::to_owned)
            .collect();
        let read = Description::load(&folder().join(file), &joints);
        read.map(|_| ()).expect_err(file).to_string()
    };
    let all = choose("two_arms.xml", "");
    assert!(
        all.contains("begin at left_1, right_1") && all.contains("--joints"),
        "{all}"
    );
    let both = choose("two_arms.xml", "left_1,right_1");
    assert!(both.contains("do not lie on one chain"), "{both}");
    let order = choose("two_arms.xml", "left_2,left_1");
    assert!(order.contains("give --joints left_1,left_2"), "{order}");
    let none = choose("two_arms.xml", "left_9");
    assert!(
        none.contains("no joint \"left_9\"") && none.contains("left_3"),
        "{none}"
    );
    let float = choose("free_base.xml", "float");
    assert!(float.contains("ball or free"), "{float}");
    let tied = choose("gripper.xml", "left,left_tip");
    assert!(tied.contains("tendon \"belt\" ties body"), "{tied}");
}
