"""What cannot be read off the files themselves."""


def each(key, values, **more):
    """Arguments that differ in one."""
    return [{key: value, **more} for value in values.split()]


# a xacro that makes several robots, or has no presets: by the end of its path, the arguments that it is read with
ARGUMENTS = {
    "denso_robot_descriptions/urdf/denso_robot.urdf.xacro": each("model", "cobotta hsr065a1_n32 vs060"),
    "limo_description/urdf/limo_four_diff.xacro": [{"robot_namespace": "limo"}],
    "limo_s2_description/urdf/limo_s2.xacro": [{"robot_namespace": "limo"}],
    "limo_s2_description/urdf/limo_s2_with_arm.xacro": [{"robot_namespace": "limo"}],
    "urdf/ur.urdf.xacro": each("ur_type", "ur3 ur5 ur10 ur3e ur5e ur10e ur16e ur20 ur30", name="ur"),
    "urdf/ur_mocked.urdf.xacro": each("ur_type", "ur5e", name="ur"),
    "ur_description/urdf/ur.xacro": each("ur_type", "ur5e"),
    "xarm_description/urdf/xarm_device.urdf.xacro": [*each("dof", "5 6 7"), *each("robot_type", "lite uf850", dof="6")],
    "ur_gazebo/urdf/ur.xacro": [{"robot_model": "ur5"}],
    "_description/xacro/robot.xacro": [{"DEBUG": "false"}],
    "interbotix_uxarm_descriptions/urdf/uxarm_gripper.urdf.xacro": [{"robot_name": "uxarm"}],
    "kortex_description/robots/kinova.urdf.xacro": [{"name": "arm", "arm": "gen3", "dof": "7", "vision": "false"}],
}


def arguments(path):
    """Each set of arguments that a file is read with."""
    return next((given for end, given in ARGUMENTS.items() if str(path).endswith(end)), [{}])
