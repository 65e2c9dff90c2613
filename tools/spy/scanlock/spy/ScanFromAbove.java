// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
package scanlock.spy;

import java.awt.Color;
import java.awt.Graphics2D;
import java.awt.event.ActionEvent;
import java.nio.ByteBuffer;
import java.nio.ByteOrder;
import java.util.Arrays;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;

/**
 * lcm-spy plug-in: bot_core.pointcloud2_t, or the sectors of a scan, seen from above and coloured by height. It also
 * takes over the double-click: the spy's own viewer would list the bytes of a scan one by one and die of it.
 */
public class ScanFromAbove implements SpyPlugin {
  @Override public boolean canHandle(long fingerprint) {
    return fingerprint == bot_core.pointcloud2_t.LCM_FINGERPRINT || fingerprint == scanlock.scan_sector_t.LCM_FINGERPRINT;
  }

  /** The spy asks with nulls, too, when it only wants the name. */
  @Override public Action getAction(final JDesktopPane desktop, final ChannelData channel) {
    return new AbstractAction("Scan from above") {
      @Override public void actionPerformed(ActionEvent event) {
        if (desktop != null && channel != null) new View(channel.fingerprint).open(desktop, "Scan", channel.name);
      }
    };
  }

  private static class View extends TopView {
    private static final int MAX_DRAWN = 150000;
    private static final int FLOAT32 = 7, FLOAT64 = 8;
    private final boolean sectors;
    private float[] x = {}, y = {}, z = {};
    // Points of the scan whose sectors are arriving.
    private final float[][] collected = new float[3][MAX_DRAWN];
    private int collectedPoints, collectedSectors;
    private long collectedUtime;

    View(long fingerprint) { sectors = fingerprint == scanlock.scan_sector_t.LCM_FINGERPRINT; }

    @Override public void messageReceived(LCM lcm, String channel, LCMDataInputStream input) {
      try {
        if (sectors) collect(new scanlock.scan_sector_t(input));
        else show(new bot_core.pointcloud2_t(input));
      } catch (java.io.IOException | RuntimeException | OutOfMemoryError wrong) {
        setHeading("a message could not be read: " + wrong);
      }
    }

    /** A scan is shown when the next one begins, whether all of its sectors came or not. */
    private void collect(scanlock.scan_sector_t sector) {
      if (sector.utime != collectedUtime) {
        synchronized (this) {
          x = Arrays.copyOf(collected[0], collectedPoints);
          y = Arrays.copyOf(collected[1], collectedPoints);
          z = Arrays.copyOf(collected[2], collectedPoints);
        }
        setHeading(String.format("%d points   %d of %d sectors   %s   %.3f s", collectedPoints, collectedSectors,
            sector.sector_count, sector.frame_id, collectedUtime * 1e-6));
        collectedUtime = sector.utime;
        collectedPoints = collectedSectors = 0;
      }
      ++collectedSectors;
      for (int i = 0; i < sector.num_points && collectedPoints < MAX_DRAWN; ++i, ++collectedPoints) {
        collected[0][collectedPoints] = sector.coordinate_scale * sector.x[i];
        collected[1][collectedPoints] = sector.coordinate_scale * sector.y[i];
        collected[2][collectedPoints] = sector.coordinate_scale * sector.z[i];
      }
    }

    private void show(bot_core.pointcloud2_t scan) {
      int total = (int) Math.min((long) scan.width * scan.height, MAX_DRAWN * 100L);
      int stride = Math.max(1, total / MAX_DRAWN), kept = 0;
      float[] newX = new float[total / stride + 1], newY = newX.clone(), newZ = newX.clone();
      ByteBuffer data = ByteBuffer.wrap(scan.data);
      data.order(scan.is_bigendian ? ByteOrder.BIG_ENDIAN : ByteOrder.LITTLE_ENDIAN);
      bot_core.pointfield_t fieldX = field(scan, "x"), fieldY = field(scan, "y"), fieldZ = field(scan, "z");
      for (int i = 0; i < total; i += stride) {
        int row = i / scan.width, column = i % scan.width;
        int at = row * (scan.height > 1 ? scan.row_step : 0) + column * scan.point_step;
        float px = value(data, at, fieldX), py = value(data, at, fieldY), pz = value(data, at, fieldZ);
        float sum = px + py + pz;
        if (Float.isNaN(sum) || Float.isInfinite(sum) || (px == 0 && py == 0 && pz == 0)) continue;
        newX[kept] = px;
        newY[kept] = py;
        newZ[kept++] = pz;
      }
      synchronized (this) {
        x = Arrays.copyOf(newX, kept);
        y = Arrays.copyOf(newY, kept);
        z = Arrays.copyOf(newZ, kept);
      }
      setHeading(String.format("%d points, %d drawn   seq %d   %s   %.3f s", (long) scan.width * scan.height, kept,
          scan.seq, scan.frame_id, scan.utime * 1e-6));
    }

    private static bot_core.pointfield_t field(bot_core.pointcloud2_t scan, String name) {
      for (bot_core.pointfield_t field : scan.fields)
        if (field.name.equals(name) && (field.datatype == FLOAT32 || field.datatype == FLOAT64)) return field;
      throw new IllegalArgumentException("no float field " + name);
    }

    private static float value(ByteBuffer data, int at, bot_core.pointfield_t field) {
      return field.datatype == FLOAT32 ? data.getFloat(at + field.offset) : (float) data.getDouble(at + field.offset);
    }

    /** The middle 96 % in each direction: one far return must not shrink the rest to a dot. */
    @Override synchronized double[] extent() {
      if (x.length == 0) return null;
      float[] sortedX = x.clone(), sortedY = y.clone();
      Arrays.sort(sortedX);
      Arrays.sort(sortedY);
      int low = x.length / 50, high = x.length - 1 - low;
      return new double[] {sortedX[low], sortedY[low], sortedX[high], sortedY[high]};
    }

    @Override synchronized void paintContents(Graphics2D graphics) {
      Color[] palette = new Color[64];
      for (int i = 0; i < palette.length; ++i) palette[i] = Color.getHSBColor(0.7f * (1 - i / 63f), 0.8f, 1f);
      float[] heights = z.clone();
      Arrays.sort(heights);
      float low = heights.length == 0 ? 0 : heights[heights.length / 50];
      float high = heights.length == 0 ? 1 : heights[heights.length - 1 - heights.length / 50];
      for (int i = 0; i < x.length; ++i) {
        float share = (z[i] - low) / Math.max(high - low, 0.1f);
        graphics.setColor(palette[(int) Math.max(0, Math.min(63, share * 63))]);
        graphics.fillRect(screenX(x[i]), screenY(y[i]), 2, 2);
      }
      graphics.setColor(Color.WHITE);
      graphics.drawLine(screenX(0) - 5, screenY(0), screenX(0) + 5, screenY(0));
      graphics.drawLine(screenX(0), screenY(0) - 5, screenX(0), screenY(0) + 5);
    }
  }
}
