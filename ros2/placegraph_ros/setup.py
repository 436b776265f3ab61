"""The build of an ament_python package."""

from setuptools import setup

NAME = "placegraph_ros"

setup(
    name=NAME,
    version="0.1.0",
    packages=[NAME],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/launch", ["launch/placegraph.launch.py"]),
        (f"share/{NAME}/config", ["config/placegraph.yaml", "config/placegraph.rviz"]),
    ],
    install_requires=["setuptools", "placegraph"],
    zip_safe=True,
    maintainer="The authors of placegraph",
    maintainer_email="placegraph@users.noreply.github.com",
    description="Corridors, rooms, doorways and how they connect, from the occupancy grid on /map.",
    license="MIT OR Apache-2.0",
    entry_points={"console_scripts": [f"placegraph = {NAME}.node:main"]},
)
