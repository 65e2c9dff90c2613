// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
package scanlock.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Graphics2D;
import java.awt.event.ActionEvent;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;

/** lcm-spy plug-in: the path of bot_core.pose_t or scanlock.odometry_t seen from above, coloured by state. */
public class Trajectory implements SpyPlugin {
  @Override public boolean canHandle(long fingerprint) {
    return fingerprint == bot_core.pose_t.LCM_FINGERPRINT || fingerprint == scanlock.odometry_t.LCM_FINGERPRINT;
  }

  /** The spy asks with nulls, too, when it only wants the name. */
  @Override public Action getAction(final JDesktopPane desktop, final ChannelData channel) {
    return new AbstractAction("Trajectory from above") {
      @Override public void actionPerformed(ActionEvent event) {
        if (desktop != null && channel != null)
          new View(channel.fingerprint).open(desktop, "Trajectory", channel.name);
      }
    };
  }

  private static class View extends TopView {
    private static final int MAX_POSES = 100000;
    private static final String[] STATES = {"INITIALISING", "TRACKING", "DEGRADED", "RECOVERING", "AMBIGUOUS", "LOST"};
    private static final Color[] COLOURS = {Color.GRAY, new Color(90, 200, 120), new Color(240, 200, 60),
        new Color(255, 140, 40), new Color(200, 110, 255), new Color(240, 70, 70)};
    private static final byte TRACKING = 1;

    private final boolean odometry;
    private final double[] x = new double[MAX_POSES], y = new double[MAX_POSES];
    private final byte[] state = new byte[MAX_POSES];
    private int count;
    private double length, yaw;
    private final double[] last = new double[3];

    View(long fingerprint) { odometry = fingerprint == scanlock.odometry_t.LCM_FINGERPRINT; }

    @Override public void messageReceived(LCM lcm, String channel, LCMDataInputStream input) {
      try {
        if (odometry) {
          scanlock.odometry_t message = new scanlock.odometry_t(input);
          add(message.pos, message.quat, message.state);
        } else {
          bot_core.pose_t message = new bot_core.pose_t(input);
          add(message.pos, message.orientation, TRACKING);
        }
      } catch (java.io.IOException | RuntimeException wrong) {
        setHeading("a message could not be read: " + wrong);
      }
    }

    private synchronized void add(double[] position, double[] q, byte newState) {
      if (Double.isNaN(position[0] + position[1]) || Double.isInfinite(position[0] + position[1])) return;
      if (count == MAX_POSES) thin();
      if (count > 0)
        length += Math.sqrt(Math.pow(position[0] - last[0], 2) + Math.pow(position[1] - last[1], 2)
            + Math.pow(position[2] - last[2], 2));
      System.arraycopy(position, 0, last, 0, 3);
      yaw = Math.atan2(2 * (q[0] * q[3] + q[1] * q[2]), 1 - 2 * (q[2] * q[2] + q[3] * q[3]));
      x[count] = position[0];
      y[count] = position[1];
      state[count++] = newState >= 0 && newState < STATES.length ? newState : 0;
      setHeading(String.format("x %.2f  y %.2f  z %.2f m   yaw %.1f deg   path %.1f m%s", position[0], position[1],
          position[2], Math.toDegrees(yaw), length, odometry ? "   " + STATES[state[count - 1]] : ""));
    }

    /** Keeps every second pose, so that a day of them stays drawable. */
    private void thin() {
      for (int i = 0; i < count / 2; ++i) {
        x[i] = x[2 * i];
        y[i] = y[2 * i];
        state[i] = state[2 * i];
      }
      count /= 2;
    }

    @Override synchronized double[] extent() {
      if (count == 0) return null;
      double[] box = {x[0], y[0], x[0], y[0]};
      for (int i = 1; i < count; ++i) {
        box[0] = Math.min(box[0], x[i]);
        box[1] = Math.min(box[1], y[i]);
        box[2] = Math.max(box[2], x[i]);
        box[3] = Math.max(box[3], y[i]);
      }
      return box;
    }

    @Override synchronized void paintContents(Graphics2D graphics) {
      graphics.setStroke(new BasicStroke(2));
      for (int i = 1; i < count; ++i) {
        graphics.setColor(COLOURS[state[i]]);
        graphics.drawLine(screenX(x[i - 1]), screenY(y[i - 1]), screenX(x[i]), screenY(y[i]));
      }
      if (count == 0) return;
      int atX = screenX(x[count - 1]), atY = screenY(y[count - 1]);
      graphics.setColor(Color.WHITE);
      graphics.fillOval(atX - 4, atY - 4, 9, 9);
      graphics.drawLine(atX, atY, atX + (int) (18 * Math.cos(yaw)), atY - (int) (18 * Math.sin(yaw)));
    }
  }
}
