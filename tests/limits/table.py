"""The manual's table of limits, row by row: where the method is seen to fail, and where heun's answer is held.

What is tested elsewhere anyway is referred to, not written twice.
"""

from __future__ import annotations

LIMITS = {
    "one chart for all attitudes (Rodrigues' κ)": {
        "limits/test_attitudes.py": ("a_global_chart_does_not_pass_half_a_turn", "heun_turns_on",
                                     "two_quarter_turns_have_no_sum_in_a_chart",
                                     "heun_has_the_failing_chart_in_its_list"),
        "laws/test_attitudes.py": ("they_are_the_rotations_and_go_on", "a_rotor_turns_through_720_degrees"),
    },
    "Euler's angles": {
        "limits/test_attitudes.py": ("eulers_angles_lose_their_digits",
                                     "eulers_angles_lose_the_attitude_and_heun_keeps_it"),
        "closed_forms/test_motion_cases.py": ("case_2_sleeping_top",),
    },
    "y + h y′": {
        "limits/test_attitudes.py": ("eulers_method_flips_at_the_wrong_time", "heun_flips_in_time",
                                     "heun_says_from_when_rounding_turns_it", "without_a_disturbance_nothing_flips"),
    },
    "factor of the mass matrix": {
        "limits/test_masses.py": ("the_mass_matrix_of_thin_rods_is_singular", "heun_does_not_know_the_axial_inertia"),
        "laws/test_thin_rods.py": ("any_axial_inertia_gives_the_same", "a_moment_about_the_axis_is_refused"),
    },
    "the printed rows of (58), (61)": {
        "limits/test_masses.py": ("the_printed_rows_divide_by_nothing", "heun_cuts_a_thin_rod"),
    },
    "Cholesky of J M⁻¹ Jᵀ": {
        "limits/test_poses.py": ("normal_equations_square_the_condition", "normal_equations_lose_the_windows",
                                 "normal_equations_lose_the_reactions", "at_the_flat_pose_it_is_open"),
        "closed_forms/test_nearly_singular.py": ("three_rods_nearly_through_one_point",),
        "references/test_windows.py": ("exact_motion", "pin_reactions", "forty_windows"),
    },
    "least squares": {
        "limits/test_poses.py": ("a_mean_solution_answers_what_has_no_acceleration",),
        "closed_forms/test_flat_parallelogram.py": ("rates_of_a_branch_pass", "other_rates_have_no_acceleration"),
    },
    "the slider, the tip as coordinates": {
        "limits/test_poses.py": ("the_slider_is_no_coordinate_at_the_dead_centre",
                                 "the_tip_is_no_coordinate_of_a_stretched_chain"),
        "closed_forms/test_blows.py": ("12_at_the_dead_centre", "a_stretched_chain_passes_the_whole_blow_on"),
    },
    "dropping dependent rows": {
        "limits/test_redundant.py": ("the_hinge_that_is_named_last_carries_nothing", "heun_leaves_the_door_open",
                                     "which_row_is_dropped_decides_what_bricard_s_hinge_carries",
                                     "heun_counts_bricard_s_freedom_and_leaves_its_hinges_open"),
        "closed_forms/test_redundant.py": ("door", "three_balls", "beam_on_three_supports"),
        "references/test_bricard.py": ("open_components", "certain_sums_are_certain"),
        "references/test_published.py": ("every_number_agrees",),
    },
    "least norm": {
        "limits/test_redundant.py": ("least_squares_depend_on_the_unit_of_length",),
        "closed_forms/test_redundant.py": ("door_split_by_least_norm_and_by_stiffness",),
    },
    "closures in accelerations alone": {
        "limits/test_time.py": ("a_bar_gets_shorter_that_is_held_in_accelerations_alone", "heun_keeps_its_length"),
        "convergence/test_long_runs.py": ("four_bar_for_a_hundred_seconds", "bricard_for_twenty_seconds"),
    },
    "one run by itself": {
        "limits/test_time.py": ("a_single_run_is_wrong_and_does_not_know_it",
                                "heun_says_where_it_ends_and_is_right_before"),
        "references/test_double_pendulum.py": ("reference", "nothing_is_claimed_beyond_the_horizon"),
    },
    "explicit steps of fixed length": {
        "limits/test_time.py": ("explicit_steps_on_a_stiff_spring_have_a_bound", "heun_follows_it",
                                 "heun_s_own_steps_of_given_length_own_up",
                                 "the_governor_s_struts_are_too_stiff_for_given_steps"),
        "references/test_governor.py": ("ten_seconds",),
    },
    "s × M/s², 1/(N Q²)": {
        "limits/test_wrenches.py": ("a_pure_couple_has_no_axis", "a_cut_in_pure_shear_has_no_reduction_line"),
        "laws/test_sections.py": ("degenerate_lines_are_flagged",),
    },
    "a guide in place of a wall": {
        "limits/test_wrenches.py": ("a_guide_pulls_where_a_wall_could_not",),
        "closed_forms/test_closed_chains.py": ("ladder_at_an_instant", "ladder_sliding_down"),
    },
}  # fmt: skip
